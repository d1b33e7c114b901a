#!/usr/bin/env python3
"""Holds the commands of README's "Five minutes with every tool" to what is there.

usage: scripts/dev/check_readme.py [BUILD] [--run]

Of every command it checks, without running it, that
- the program exists;
- each flag is in the --help of that program or subcommand;
- each file that it reads is in the repository, or in what a command before it has written.

--run runs the commands too, one after another as they are typed, in a scratch folder that has the
repository's folders, with small numbers in the place of README's (2 scenes, 16x12 pixels, ...).
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

ROOT = pathlib.Path(__file__).resolve().parents[2]
SECTION = "## Five minutes with every tool"
FOLDERS = ("assets", "configs", "scripts", "examples", "docs")
OUTPUTS = ("--out", "--report", "--json", "--csv", "--save-embedding")
# Flags with small values, for --run; and what replaces or follows a command that has none.
SMALL = {"--size": "16x12", "--scenes": "6", "--rays": "8", "--spp": "2", "--queries": "50"}
SETTINGS = {"train.steps": "2", "test_share": "0.34"}
TINY = {
    "lte_datagen generate": "--set query_points=64 --set scene_points=256 --set rays=8 "
                            "--set views.rays=8 --set test_share=0.34 --set val_share=0.2 "
                            "--set homes.rooms=[1,1] --set homes.detail=[0.5,0.5] "
                            "--set boxes.texture_sizes=[64]",
    "lte_datagen bake": "--view-rays 1",
    "lte_train": "--set train.validate_every=1000 --set data.queries_per_scene=32 "
                 "--set data.scene_points=128",
    "lte_eval scenes": "--size 16x12 --reference-spp 2 --methods network,paths-2",
    "lte_eval": "--resamples 20",
}
DROPPED = ("--verify", )  # flags that take a minute whatever the size
LONG = ("lte_eval --split test", "lte_bench", "lte_view")  # commands that do, which are not run


def section(text):
    """The lines of the section that are code."""
    body = text.split(SECTION + "\n", 1)[1].split("\n## ", 1)[0]
    return [line[4:] for line in body.splitlines() if line.startswith("    ")]


def commands(text):
    """The commands, continued lines joined and comments taken off."""
    out, rest = [], ""
    for line in section(text):
        line = re.sub(r"(^|\s)#.*$", "", line).rstrip()
        if line.endswith("\\"):
            rest += line[:-1] + " "
            continue
        if (rest + line).strip():
            out.append(" ".join((rest + line).split()))
        rest = ""
    return out


class Checker:
    def __init__(self, build):
        self.bin = build / "bin"
        self.helps, self.written = {}, []

    def program(self, name):
        """Where a command's first word is; None if nowhere."""
        places = [self.bin / pathlib.Path(name).name]
        if "/" in name:
            places.append(ROOT / name)
        return next((place for place in places if place.exists()), None)

    def help_of(self, program, sub):
        key = (program, sub)
        if key not in self.helps:
            done = subprocess.run([str(program), *([sub] if sub else []), "--help"],
                                  capture_output=True, text=True, stdin=subprocess.DEVNULL)
            self.helps[key] = done.stdout
        return self.helps[key]

    def is_there(self, path):
        made = any(path == out or path.startswith(out.rstrip("/") + "/") for out in self.written)
        return made or (ROOT / path).exists()

    def faults(self, command):
        words = shlex.split(command)
        if words[0] == "export":
            return
        if words[0].endswith("launch.sh"):
            if not self.is_there(words[0]):
                yield f"{words[0]} does not exist"
            words = words[2:]
        program = self.program(words[0])
        if program is None:
            yield f"{words[0]} is no program of {self.bin}"
            return
        sub = words[1] if len(words) > 1 and words[0] in ("lte_datagen", "lte_bench") else ""
        if words[:2] in (["lte_train", "report"], ["lte_eval", "scenes"]):
            sub = words[1]
        text = self.help_of(program, sub)
        if words[0] == "lte_eval" and sub:  # its commands take the common flags of the tool
            text += self.help_of(program, "")
        outputs = []
        for i, word in enumerate(words[1:], 1):
            before = words[i - 1]
            if word.startswith("--"):
                if not re.search(rf"(?<![\w-]){re.escape(word)}(?![\w-])", text):
                    yield f"{words[0]} {sub} has no flag {word}".replace("  ", " ")
            elif before in OUTPUTS or (words[0] == "render_room" and i > 1):
                outputs.append(word)
            elif before == "--set":
                value = word.partition("=")[2]
                if "/" in value and not self.is_there(value):
                    yield f"{value} ({word}) is neither in the repository nor written before"
            elif re.search(r"\.\w{2,}$|/", word) and not re.fullmatch(r"\d+/\d+", word):
                if not self.is_there(word):
                    yield f"{word} is neither in the repository nor written before"
        self.written += outputs


def small(command):
    """The command with small numbers, or None for one that takes long whatever they are."""
    if any(part in command for part in LONG):
        return None
    words = [word for word in shlex.split(command) if word not in DROPPED]
    for i, word in enumerate(words[:-1]):
        if word in SMALL:
            words[i + 1] = SMALL[word]
        key = words[i + 1].partition("=")[0]
        if word == "--set" and key in SETTINGS:
            words[i + 1] = f"{key}={SETTINGS[key]}"
    line = shlex.join(words)
    takes_settings = words[1:2] not in (["report"], ["health"])
    for start, more in TINY.items():
        if start in line and takes_settings and "--dry-run" not in line:
            have = {words[i + 1].partition("=")[0] for i, w in enumerate(words) if w == "--set"}
            extra = shlex.split(more)
            pairs = [extra[i:i + 2] for i in range(0, len(extra), 2)]
            pairs = [p for p in pairs if p[0] != "--set" or p[1].partition("=")[0] not in have]
            line += " " + shlex.join(word for pair in pairs for word in pair)
            break
    return line


def run_all(lines, build):
    """Runs what it can; yields faults."""
    with tempfile.TemporaryDirectory(prefix="lte-readme-") as scratch:
        folder = pathlib.Path(scratch)
        for name in FOLDERS:
            (folder / name).symlink_to(ROOT / name)
        (folder / "build").symlink_to(build.resolve())
        environment = {**os.environ, "PATH": f"{build.resolve() / 'bin'}:{os.environ['PATH']}"}
        for command in lines:
            line = None if command.startswith("export ") else small(command)
            if line is None:
                continue
            started = time.monotonic()
            done = subprocess.run(["bash", "-c", line], cwd=folder, env=environment, text=True,
                                  capture_output=True, stdin=subprocess.DEVNULL, timeout=300)
            print(f"{time.monotonic() - started:6.1f} s  {line}", flush=True)
            if done.returncode != 0:
                said = (done.stderr or done.stdout).strip().splitlines()
                yield f"{command}: exit code {done.returncode}: {said[-1] if said else ''}"


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", nargs="?", type=pathlib.Path, default=ROOT / "build")
    parser.add_argument("--run", action="store_true", help="run the commands at a small size too")
    arguments = parser.parse_args()
    lines = commands((ROOT / "README.md").read_text())
    checker = Checker(arguments.build)
    found = [f"{line}: {fault}" for line in lines for fault in checker.faults(line)]
    if arguments.run and not found:
        found = list(run_all(lines, arguments.build))
    for fault in found:
        print(f"README.md: {fault}")
    print(f"readme: {len(found)} faults in {len(lines)} commands")
    return 1 if found or not lines else 0


if __name__ == "__main__":
    sys.exit(main())
