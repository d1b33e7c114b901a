#!/usr/bin/env python3
"""Holds the commands and C programs of README.md and docs/ to what is there.

usage: scripts/dev/check_readme.py [BUILD] [--run] [--root ROOT]

Commands are the lines of fenced blocks: ```sh, or ```sh no-run for what takes long, needs a network
or other files than the repository's. Without running anything it checks of each command that
- the program exists;
- each flag is in the --help of that program or subcommand;
- each file that it reads is in the repository, or written by a command of the page before it.
Of no-run blocks it checks the flags of lte's programs alone. A ```c block that begins with an
#include is compiled.

--run runs the commands, too, a page after another as they are typed, in a scratch folder that has
the repository's folders, with small numbers in the place of the page's (16x12 pixels, 2 steps).
"""
import argparse
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import time

FOLDERS = ("assets", "configs", "scripts", "examples", "docs")
OUTPUTS = ("--out", "--report", "--json", "--save-embedding")
# Flags with small values, for --run; and what is appended to a command unless it has the key.
SMALL = {"--size": "16x12", "--scenes": "6", "--rays": "8", "--spp": "2", "--queries": "50",
         "--reference-spp": "2", "--time": "0.2s", "--quality": "draft"}
TINY = {
    "lte_datagen generate": "--set query_points=64 --set scene_points=256 --set rays=8 "
                            "--set views.rays=8 --set test_share=0.34 --set val_share=0.2 "
                            "--set homes.rooms=[1,1] --set homes.detail=[0.5,0.5] "
                            "--set boxes.texture_sizes=[64]",
    "lte_datagen bake": "--view-rays 1",
    "lte_train": "--set train.steps=STEPS --set train.validate_every=1000 "
                 "--set data.queries_per_scene=32 --set data.scene_points=128",
    "lte_eval scenes": "--methods gather,paths-2",
    "--split test": "--resamples 20",
    "lte_view": "--validate-only",  # which serves nothing, and ends
}
STEPS = 2  # of a training; a command further down the page has as many more
PLAIN = ("report", "health", "average")  # commands of lte_train without a configuration
WHOLE_FILE = re.compile(r"\s*#include")


def blocks(text):
    """Language, rest of the fence's line and lines of every fenced block."""
    for found in re.finditer(r"^```(\w+)([^\n]*)\n(.*?)^```$", text, flags=re.M | re.S):
        yield found.group(1), found.group(2).strip(), found.group(3).splitlines()


def commands(lines):
    """Commands of a block: continued lines joined, comments taken off."""
    rest = ""
    for line in lines:
        line = re.sub(r"(^|\s)#.*$", "", line).rstrip()
        if line.endswith("\\"):
            rest += line[:-1] + " "
            continue
        if (rest + line).strip():
            yield " ".join((rest + line).split())
        rest = ""


def pages(root):
    return [root / "README.md", *sorted((root / "docs").glob("*.md"))]


class Checker:
    """What the commands of one page may name."""

    def __init__(self, root, build, helps):
        self.root, self.bin, self.helps, self.written = root, build / "bin", helps, []

    def program(self, name):
        """Where a command's first word is; None if nowhere."""
        places = [self.bin / pathlib.Path(name).name]
        if "/" in name:
            places.append(self.root / name)
        return next((place for place in places if place.exists()), None)

    def help_of(self, program, sub=""):
        key = (program, sub)
        if key not in self.helps:
            done = subprocess.run([str(program), *([sub] if sub else []), "--help"],
                                  capture_output=True, text=True, stdin=subprocess.DEVNULL)
            self.helps[key] = done.stdout
        return self.helps[key]

    def flags_of(self, program, words):
        """Help of a program, and that of the subcommand that a command names."""
        text = self.help_of(program)
        listed = text.partition("Subcommands:")[2]
        if len(words) > 1 and re.search(rf"^  {re.escape(words[1])}\s", listed, flags=re.M):
            text += self.help_of(program, words[1])
        return text

    def is_there(self, path):
        made = any(path == out or path.startswith(out.rstrip("/") + "/") for out in self.written)
        return made or (self.root / path).exists()

    def flag_faults(self, program, words):
        text = self.flags_of(program, words)
        for word in words[1:]:
            flag = word.partition("=")[0]
            if word.startswith("--") and not re.search(rf"(?<![\w-]){re.escape(flag)}(?![\w-])",
                                                       text):
                yield f"{words[0]} has no flag {flag}"

    def file_faults(self, words):
        outputs = []
        for i, word in enumerate(words[1:], 1):
            before = words[i - 1]
            if word.startswith("--"):
                continue
            if before in OUTPUTS or (words[0] == "render_room" and i > 1):
                outputs.append(word)
            elif before == "--set":
                value = word.partition("=")[2]
                if "/" in value and not self.is_there(value):
                    yield f"{value} ({word}) is neither in the repository nor written before"
            elif re.search(r"\.[a-z]\w+$|/", word) and not re.fullmatch(r"\d+/\d+", word):
                if not self.is_there(word):
                    yield f"{word} is neither in the repository nor written before"
        self.written += outputs

    def faults(self, command, runs):
        words = shlex.split(command)
        if words[0] == "export":
            return
        if words[0].endswith("launch.sh"):
            if not (self.root / words[0]).exists():
                yield f"{words[0]} does not exist"
            words = words[2:]
        program = self.program(words[0])
        if program is None:
            if runs or words[0].startswith("lte_"):
                yield f"{words[0]} is no program of {self.bin}"
            return
        if program.parent == self.bin:
            yield from self.flag_faults(program, words)
        if runs:
            yield from self.file_faults(words)


def small(command, steps):
    """The command with small numbers."""
    words = shlex.split(command)
    for i, word in enumerate(words[:-1]):
        if word in SMALL:
            words[i + 1] = SMALL[word]
        if word == "--set" and words[i + 1].startswith("train.steps="):
            words[i + 1] = f"train.steps={steps}"
    line = shlex.join(words)
    if words[1:2] and words[1] in PLAIN or "--dry-run" in words or "--print-config" in words:
        return line
    for start, more in TINY.items():
        if start not in line:
            continue
        have = {words[i + 1].partition("=")[0] for i, word in enumerate(words) if word == "--set"}
        extra = shlex.split(more.replace("STEPS", str(steps)))
        for i, word in enumerate(extra):
            if word != "--set" and extra[i - 1] != "--set":
                line += " " + word
            elif word == "--set" and extra[i + 1].partition("=")[0] not in have:
                line += f" --set {shlex.quote(extra[i + 1])}"
        break
    return line


def run_page(lines, root, build):
    """Runs the commands of a page; yields faults."""
    with tempfile.TemporaryDirectory(prefix="lte-readme-") as scratch:
        folder = pathlib.Path(scratch)
        for name in FOLDERS:
            if (root / name).exists():
                (folder / name).symlink_to(root / name)
        (folder / "build").symlink_to(build.resolve())
        environment = {**os.environ, "PATH": f"{build.resolve() / 'bin'}:{os.environ['PATH']}"}
        steps = 0
        for command in lines:
            if command.startswith("export "):
                continue
            steps += STEPS
            line, started = small(command, steps), time.monotonic()
            try:
                done = subprocess.run(["bash", "-c", line], cwd=folder, env=environment, text=True,
                                      capture_output=True, stdin=subprocess.DEVNULL, timeout=120)
                code, said = done.returncode, (done.stderr or done.stdout).strip().splitlines()
            except subprocess.TimeoutExpired:
                code, said = "none", ["it runs for more than two minutes"]
            print(f"{time.monotonic() - started:6.1f} s  {line}", flush=True)
            if code != 0:
                yield f"{command}: exit code {code}: {said[-1] if said else ''}"


def compile_faults(lines, root):
    done = subprocess.run(["cc", "-std=c99", "-Wall", "-Werror", "-fsyntax-only", f"-I{root}",
                           "-xc", "-"], input="\n".join(lines), capture_output=True, text=True)
    if done.returncode != 0:
        yield f"a C program does not compile: {done.stderr.splitlines()[0]}"


def check_page(page, root, build, helps, run):
    """Commands that were looked at, and faults."""
    checker, found, all_lines, to_run = Checker(root, build, helps), [], [], []
    for language, mark, lines in blocks(page.read_text()):
        if language == "c" and lines and WHOLE_FILE.match(lines[0]):
            found += compile_faults(lines, root)
        if language != "sh":
            continue
        if mark not in ("", "no-run"):
            found.append(f'```sh {mark}: a block is "sh" or "sh no-run"')
        for command in commands(lines):
            found += [f"{command}: {fault}" for fault in checker.faults(command, mark == "")]
            all_lines.append(command)
            if mark == "":
                to_run.append(command)
    if run and not found:
        found += run_page(to_run, root, build)
    return all_lines, found


def main():
    default = pathlib.Path(__file__).resolve().parents[2]
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", nargs="?", type=pathlib.Path)
    parser.add_argument("--run", action="store_true", help="run the commands at a small size too")
    parser.add_argument("--root", type=pathlib.Path, default=default, help="the source tree")
    arguments = parser.parse_args()
    root = arguments.root.resolve()
    build = arguments.build or root / "build"
    helps, count, faults = {}, 0, 0
    for page in pages(root):
        lines, found = check_page(page, root, build, helps, arguments.run)
        for fault in found:
            print(f"{page.relative_to(root)}: {fault}")
        count, faults = count + len(lines), faults + len(found)
    print(f"readme: {faults} faults in {count} commands")
    return 1 if faults or not count else 0


if __name__ == "__main__":
    sys.exit(main())
