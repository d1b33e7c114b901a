#!/usr/bin/env python3
"""Fails on a header that does not compile alone, with the flags of a source beside it.

usage: scripts/dev/check_headers.py [--build build] [--jobs N] [--all] [--no-pch]
                                    [--base REVISION | HEADER ...]

A header that the source of its own name includes before all else has passed already: the build
compiles that source. Each of the others becomes a translation unit of one #include, which the
compiler only parses.

LibTorch costs 20 seconds of processor time in each unit that includes it. So those are parsed by
clang, where it is installed, behind a precompiled lte/nn/pch.h whose templates are instantiated
once: 2 seconds each. That hides a missing include of what LibTorch's umbrella header brings, as the
build's own precompiled header does; --no-pch finds those too, and then looks at all headers.

A header that has passed is not looked at again until it, a header of ours that it includes, or its
flags change (the record is headers.json in the build folder); --all forgets the record. --base
looks at the headers alone that differ from a revision and those that include one of them directly.
"""
import argparse
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
OWN_INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"', re.M)
# A third party that this machine lacks, and whose users it does not build either.
MISSING = re.compile(r"fatal error: '?((?!torch/|ATen/|c10/)[\w./+-]+?)'?(?: file not|: No such)")
TORCH_INCLUDE = re.compile(r"^\s*#\s*include\s*<(torch|ATen|c10)/", re.M)
FOLDERS = ("lte", "datagen", "train", "infer", "bench", "experiments", "tests")
# What clang does not take, or what would set the precompiled header's macros apart from the rest's.
GCC_ALONE = re.compile(
    r"-fpch-preprocess|-Winvalid-pch|-fopenmp|-Werror|-O\d|-W.*psabi|-ffp-.*|-fno-math-errno|"
    r"-fno-trapping-math|-m.*|-fvisibility.*")


def all_headers() -> list[str]:
    found = (path for top in FOLDERS for path in (ROOT / top).rglob("*.h"))
    return sorted(path.relative_to(ROOT).as_posix() for path in found)


def changed_headers(base: str) -> list[str]:
    """Headers that differ from a revision, and those that include one of them directly."""
    done = subprocess.run(["git", "diff", "--name-only", base, "--", "*.h"], cwd=ROOT,
                          capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"check_headers.py: --base: {done.stderr.splitlines()[0]}")
    changed = set(done.stdout.split())
    return [header for header in all_headers()
            if header in changed
            or changed.intersection(OWN_INCLUDE.findall((ROOT / header).read_text()))]


def words_of(command: str) -> list[str]:
    """A command of the build without its input, its output and its precompiled header."""
    out, skip = [], False
    given = shlex.split(command)
    for i, word in enumerate(given):
        if skip:
            skip = False
        elif word in ("-o", "-c") or (word == "-include" and "cmake_pch" in given[i + 1]):
            skip = True
        elif word not in ("-Winvalid-pch", "-fpch-preprocess"):
            out.append(word)
    return out


class Flags:
    """The compiler's words for a header: those of a source in its folder, else in the nearest."""

    def __init__(self, build: pathlib.Path):
        self.by_folder: dict[str, list[tuple[str, list[str]]]] = {}
        self.sources: set[str] = set()
        for entry in json.loads((build / "compile_commands.json").read_text()):
            path = pathlib.Path(entry["directory"], entry["file"]).resolve()
            if path.suffix != ".cpp" or not path.is_relative_to(ROOT):
                continue
            self.sources.add(path.relative_to(ROOT).as_posix())
            folder = path.relative_to(ROOT).parent.as_posix()
            words = words_of(entry["command"])
            self.by_folder.setdefault(folder, []).append((entry["directory"], words))

    def of(self, header: str, torch: bool) -> tuple[str, list[str]] | None:
        """@param torch  the header needs LibTorch, which not every target of a folder knows"""
        unit = header.removesuffix(".h")
        folder = unit if unit in self.by_folder else os.path.dirname(header)  # lte/c_api.h
        while folder:
            within = [entry for name, entries in self.by_folder.items() for entry in entries
                      if name == folder or name.startswith(folder + "/")]
            beside = self.by_folder.get(folder, [])
            for choice in (beside, within):
                knows = [entry for entry in choice
                         if not torch or any("torch" in word for word in entry[1])]
                if knows:  # the one with the most flags knows every third party
                    return max(knows, key=lambda entry: len(entry[1]))
            folder = os.path.dirname(folder)
        return None


def built_first(header: str, sources: set[str]) -> bool:
    """Whether the source of its name is built and includes it before anything else."""
    source = header.removesuffix(".h") + ".cpp"
    if source not in sources:
        return False
    first = re.search(r'^\s*#\s*include\s*[<"]([^>"]+)', (ROOT / source).read_text(), re.M)
    return first is not None and first.group(1) == header


class Precompiled:
    """LibTorch parsed once, by clang."""

    def __init__(self, build: pathlib.Path, clang: str, flags: Flags):
        self.clang = clang
        directory, words = flags.of("lte/nn/pch.h", torch=True)
        self.path = build / "headers.pch"
        command = [clang, *self.clean(words), "-fpch-instantiate-templates", "-x", "c++-header",
                   str(ROOT / "lte/nn/pch.h"), "-o", str(self.path)]
        made_by = build / "headers.pch.txt"  # made anew when the flags change
        if not (self.path.exists() and made_by.exists() and made_by.read_text() == str(command)):
            subprocess.run(command, cwd=directory, check=True)
            made_by.write_text(str(command))

    @staticmethod
    def clean(words: list[str]) -> list[str]:
        return [word for word in words[1:] if not GCC_ALONE.fullmatch(word)]

    def words(self, words: list[str]) -> list[str]:
        return [self.clang, *self.clean(words), "-Wno-unknown-warning-option", "-include-pch",
                str(self.path)]


def closure(name: str, seen: dict[str, set[str]]) -> set[str]:
    """A header and all headers of ours that it includes, by way of others too."""
    if name not in seen:
        seen[name] = {name}
        for include in OWN_INCLUDE.findall((ROOT / name).read_text(errors="replace")):
            if (ROOT / include).exists():
                seen[name] |= closure(include, seen)
    return seen[name]


def digest(names: set[str], words: list[str]) -> str:
    out = hashlib.sha256("\0".join(words).encode())
    for name in sorted(names):
        out.update((ROOT / name).read_bytes())
    return out.hexdigest()


def compile_alone(header: str, directory: str, words: list[str], scratch: str) -> str:
    """The compiler's complaint, or nothing."""
    unit = pathlib.Path(scratch, header.replace("/", "__") + ".cpp")
    # Twice: a header without its guard is a fault too.
    unit.write_text(f'#include "{header}"\n#include "{header}"\n')
    done = subprocess.run([*words, f"-I{ROOT}", "-fsyntax-only", "-Wno-unused", str(unit)],
                          cwd=directory, capture_output=True, text=True)
    return "" if done.returncode == 0 else done.stderr


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("headers", nargs="*")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--base", help="look at what differs from this revision alone")
    parser.add_argument("--all", action="store_true", help="forget which ones have passed")
    parser.add_argument("--no-pch", action="store_true", help="without precompiled headers")
    parser.add_argument("--times", action="store_true", help="print the seconds of each header")
    args = parser.parse_args()
    if args.base and args.headers:
        parser.error("--base and names of headers exclude each other")
    if not (args.build / "compile_commands.json").exists():
        sys.exit(f"check_headers.py: {args.build} is not configured: cmake --preset release")
    flags = Flags(args.build)
    clang = None if args.no_pch else shutil.which("clang++")
    precompiled = None
    record_path = args.build / "headers.json"
    record = {}
    if record_path.exists() and not args.all:
        record = json.loads(record_path.read_text())

    start = time.monotonic()
    seen: dict[str, set[str]] = {}
    headers = args.headers or (changed_headers(args.base) if args.base else all_headers())
    todo, left_out, built = [], [], 0
    for header in headers:
        if not (args.headers or args.no_pch) and built_first(header, flags.sources):
            built += 1
            continue
        names = closure(header, seen)
        torch = any(TORCH_INCLUDE.search((ROOT / name).read_text()) for name in names)
        entry = flags.of(header, torch)
        if entry is None:
            left_out.append(header)
            continue
        key = digest(names, entry[1])
        if record.get(header) == key:
            continue
        if clang and torch:
            precompiled = precompiled or Precompiled(args.build, clang, flags)
            entry = (entry[0], precompiled.words(entry[1]))
        todo.append((header, entry, key))

    failed = 0
    with tempfile.TemporaryDirectory() as scratch, \
            concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
        def check(item):
            began = time.monotonic()
            return item, compile_alone(item[0], *item[1], scratch), time.monotonic() - began

        for (header, _, key), complaint, seconds in pool.map(check, todo):
            if args.times:
                print(f"{seconds:6.1f} s  {header}")
            missing = MISSING.search(complaint)
            if missing and not missing[1].startswith(FOLDERS):
                print(f"{header}: left out, as {missing[1]} is not installed")
                left_out.append(header)
            elif complaint:
                failed += 1
                record.pop(header, None)
                print(f"{header}: does not compile alone:\n" +
                      "\n".join(complaint.splitlines()[:12]))
            else:
                record[header] = key
    record_path.write_text(json.dumps(record, indent=0))
    if left_out:
        print(f"headers: nothing of this build tells how to compile {', '.join(left_out)}")
    print(f"headers: {len(headers) - len(left_out) - failed} of {len(headers)} compile alone "
          f"({built} begin the source of their name, {len(todo)} others were looked at, "
          f"{time.monotonic() - start:.0f} s)")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
