#!/usr/bin/env python3
"""Fails on a header that does not compile alone, with the flags of a source beside it.

usage: scripts/dev/check_headers.py [--build build] [--jobs N] [--all] [--no-pch] [HEADER ...]

Each header becomes a translation unit of one #include, which the compiler only parses. Where a
target has a precompiled header (LibTorch's) the check takes it too, as the build does: that brings
a header of lte/nn from 10 seconds to 2, and hides only a missing include of what lte/nn/pch.h
names; --no-pch finds those. A header that has passed is not looked at again until it, a header of
ours that it includes, or its flags change (the record is headers.json in the build folder); --all
forgets the record.
"""
import argparse
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
OWN_INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"', re.M)
FOLDERS = ("lte", "datagen", "train", "infer", "tests", "examples")


def tracked_headers() -> list[str]:
    listed = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z",
                             "*.h"], cwd=ROOT, check=True, capture_output=True, text=True).stdout
    return sorted(name for name in listed.split("\0")
                  if name.startswith(FOLDERS) and (ROOT / name).exists())


class Flags:
    """The compiler's words for a header: those of a source in its folder, else in the nearest."""

    def __init__(self, build: pathlib.Path, use_pch: bool):
        self.by_folder: dict[str, tuple[str, list[str]]] = {}
        for entry in json.loads((build / "compile_commands.json").read_text()):
            path = pathlib.Path(entry["directory"], entry["file"]).resolve()
            if path.suffix != ".cpp" or not path.is_relative_to(ROOT):
                continue
            folder = path.relative_to(ROOT).parent.as_posix()
            words = self.clean(shlex.split(entry["command"]), use_pch)
            # Several targets in a folder: the one with the most flags knows every third party.
            if folder not in self.by_folder or len(words) > len(self.by_folder[folder][1]):
                self.by_folder[folder] = (entry["directory"], words)

    @staticmethod
    def clean(words: list[str], use_pch: bool) -> list[str]:
        out, skip = [], False
        for i, word in enumerate(words):
            if skip:
                skip = False
            elif word in ("-o", "-c"):
                skip = True
            elif word == "-include" and not use_pch and "cmake_pch" in words[i + 1]:
                skip = True
            elif word != "-Winvalid-pch":
                out.append(word)
        return out

    def of(self, header: str) -> tuple[str, list[str]] | None:
        unit = header.removesuffix(".h")
        if unit in self.by_folder:  # lte/c_api.h is lte/c_api's
            return self.by_folder[unit]
        folder = os.path.dirname(header)
        while folder:
            if folder in self.by_folder:
                return self.by_folder[folder]
            below = [f for f in self.by_folder if f.startswith(folder + "/")]
            if below:
                return max((self.by_folder[f] for f in below), key=lambda entry: len(entry[1]))
            folder = os.path.dirname(folder)
        return None


def digest(header: str, words: list[str], seen: dict[str, set[str]]) -> str:
    """Of the header, all headers of ours that it includes, and its flags."""
    def closure(name: str) -> set[str]:
        if name not in seen:
            seen[name] = {name}
            for include in OWN_INCLUDE.findall((ROOT / name).read_text(errors="replace")):
                if (ROOT / include).exists():
                    seen[name] |= closure(include)
        return seen[name]

    out = hashlib.sha256("\0".join(words).encode())
    for name in sorted(closure(header)):
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
    parser.add_argument("--all", action="store_true", help="forget which ones have passed")
    parser.add_argument("--no-pch", action="store_true", help="without precompiled headers")
    parser.add_argument("--times", action="store_true", help="print the seconds of each header")
    args = parser.parse_args()
    if not (args.build / "compile_commands.json").exists():
        sys.exit(f"check_headers.py: {args.build} is not configured: cmake --preset release")
    flags = Flags(args.build, use_pch=not args.no_pch)
    record_path = args.build / "headers.json"
    record = {}
    if record_path.exists() and not args.all:
        record = json.loads(record_path.read_text())

    start = time.monotonic()
    seen: dict[str, set[str]] = {}
    headers = args.headers or tracked_headers()
    todo, left_out = [], []
    for header in headers:
        entry = flags.of(header)
        if entry is None:
            left_out.append(header)
            continue
        key = digest(header, entry[1], seen)
        if record.get(header) != key:
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
            if complaint:
                failed += 1
                record.pop(header, None)
                print(f"{header}: does not compile alone:\n" +
                      "\n".join(complaint.splitlines()[:12]))
            else:
                record[header] = key
    record_path.write_text(json.dumps(record, indent=0))
    if left_out:
        print(f"headers: no target of this build has flags for {', '.join(left_out)}")
    print(f"headers: {len(headers) - len(left_out) - failed} of {len(headers)} compile alone "
          f"({len(todo)} looked at, {time.monotonic() - start:.0f} s)")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
