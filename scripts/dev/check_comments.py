#!/usr/bin/env python3
"""Finds comments that a formatter has torn, comments that name files which are not there, and lines
over 100 columns (in CMake, shell and YAML of comments alone).

usage: scripts/dev/check_comments.py [PATH ...]      (default: all tracked sources)

A comment counts as torn where
- a line of at most 78 columns stands in mid-sentence although the next line's words would fit;
- a continuation is indented otherwise than the lines before it, with no list or @tag to explain it.
"""

import pathlib
import re
import subprocess
import sys

COLUMNS = 100
SHORT = 78  # a line that ends here in mid-sentence has been cut, not wrapped
ROOT = pathlib.Path(__file__).resolve().parents[2]
CODE = {".h", ".cpp", ".cu", ".cuh", ".c"}
OTHER = {".py", ".sh", ".cmake", ".yaml", ".txt", ".in"}
COMMENT = re.compile(r"^(?P<lead>\s*)(?P<mark>//[/!]?<?)(?P<gap>\s*)(?P<text>.*)$")
ITEM = re.compile(r"^([-*•]|\d+[.)]|[a-zA-Z]:)\s")
TAG = re.compile(r"^@\w+")
# `Units: metres ...`, as a glossary has them: its continuation may be indented.
LABEL = re.compile(r"^[A-Z][\w /]{0,40}:")
SENTENCE_END = re.compile(r"[.:;?!)\]>»”\"]$|\.\.\.$|^$")
FOLDERS = ("assets|bench|cmake|configs|datagen|docs|examples|experiments|infer|lte|scripts|tests|"
           "train")
SUFFIXES = "h|cpp|cu|c|md|py|sh|yaml|json|glb|pbrt|txt|cmake"
PATH = re.compile(rf"(?<![\w/.$-])((?:{FOLDERS})/[\w./-]*\w\.(?:{SUFFIXES}))\b")
# A formula, a shape or a sample of code is set as its author likes.
SAMPLE = re.compile(r"[{}\[\]=^→Σ]|\(\)")
FOREIGN = re.compile(r"\bDESIGN\b|\bSTYLE\.md\b")


def tracked(paths: list[str]) -> list[pathlib.Path]:
    """The sources below `paths` that git knows; in an unpacked archive all that are there."""
    git = subprocess.run(["git", "ls-files", "-z", "--", *paths], cwd=ROOT, capture_output=True,
                         text=True, check=False)
    if git.returncode == 0:
        files = [ROOT / name for name in git.stdout.split("\0") if name]
    else:
        tops = paths or ["CMakeLists.txt", *FOLDERS.split("|")]
        files = [f for top in tops for f in [ROOT / top, *(ROOT / top).rglob("*")] if f.is_file()]
    return [f for f in files if f.suffix in CODE | OTHER and f.exists() and not f.is_symlink()]


class Line:
    """A line that is a comment and nothing else."""

    def __init__(self, raw: str, match: re.Match):
        self.raw = raw
        self.lead, self.mark = match["lead"], match["mark"]
        self.indent = len(match["gap"])
        self.text = match["text"].rstrip()

    def starts_something(self) -> bool:
        return bool(
            not self.text
            or ITEM.match(self.text)
            or TAG.match(self.text)
            or LABEL.match(self.text)
            or not re.search(r"[a-zA-Z]{2}", self.text)
        )


def blocks(lines: list[str]):
    """Runs of comment lines of one mark and one indentation, each with the number of its first."""
    run, begin = [], 0
    for number, raw in enumerate([*lines, ""], 1):
        match = COMMENT.match(raw)
        line = Line(raw, match) if match else None
        if run and (line is None or line.mark != run[-1].mark or line.lead != run[-1].lead):
            yield begin, run
            run = []
        if line is not None:
            if not run:
                begin = number
            run.append(line)


def is_cut(line: Line, following: Line) -> bool:
    if SENTENCE_END.search(line.text) or following.starts_something():
        return False
    if line.indent > following.indent + 1:  # the end of a sample of code
        return False
    if SAMPLE.search(line.text) or SAMPLE.search(following.text):
        return False
    if line.text.endswith(",") and following.indent > 1:  # a formula or a table
        return False
    if 4 < line.indent == following.indent and not re.match(r"[a-z]", following.text):
        return False  # a column of its own
    first = following.text.split(" ", 1)[0]
    return len(line.raw) <= SHORT and len(line.raw) + 1 + len(first) <= COLUMNS


def torn(lines: list[str]):
    for begin, run in blocks(lines):
        anchor = run[0]  # what the indentation of continuations follows
        continuation = None  # their indentation, once there is one
        for i, line in enumerate(run):
            before = run[i - 1] if i else None
            if before is not None and is_cut(before, line):
                yield begin + i - 1, "torn: the next line's words would fit"
            if before is None or line.starts_something() or not before.text:
                anchor, continuation = line, None
                continue
            hangs = ITEM.match(anchor.text) or TAG.match(anchor.text) or LABEL.match(anchor.text)
            if continuation is None:
                ended = before.text.endswith((":", "."))
                sample = SAMPLE.search(before.text) or SAMPLE.search(line.text)
                if line.indent > anchor.indent and not hangs and not ended and not sample:
                    yield begin + i, "torn: the indentation jumps"
                continuation = line.indent
            elif (
                line.indent != continuation
                and (hangs or line.indent > continuation)
                and not before.text.endswith((":", ".", ";", ","))
                and not SAMPLE.search(before.text)
            ):
                yield begin + i, "torn: the indentation jumps"
                continuation = line.indent


def without_raw_strings(text: str) -> str:
    """Raw strings hold another language, whose lines are as long as they are."""
    return re.sub(r'R"(\w*)\(.*?\)\1"', lambda m: "\n" * m.group(0).count("\n"), text, flags=re.S)


def faults(file: pathlib.Path):
    text = file.read_text(errors="replace")
    lines = (without_raw_strings(text) if file.suffix in CODE else text).splitlines()
    for number, line in enumerate(lines, 1):
        measured = file.suffix in CODE | {".py"} or line.lstrip().startswith("#")
        if len(line) > COLUMNS and measured and "http" not in line:
            yield number, f"{len(line)} columns, at most {COLUMNS}"
        comment = line.partition("//" if file.suffix in CODE else "#")[2]
        if file.suffix in CODE and line.lstrip().startswith("#include"):
            continue
        for path in PATH.findall(comment):
            if not (ROOT / path).exists():
                yield number, f"names {path}, which does not exist"
        if FOREIGN.search(comment):
            yield number, "names a page that is not in the repository"
    if file.suffix in CODE:
        yield from torn(lines)


def main() -> int:
    count = 0
    files = tracked(sys.argv[1:])
    for file in files:
        for number, fault in sorted(faults(file)):
            count += 1
            print(f"{file.relative_to(ROOT)}:{number}: {fault}")
    print(f"comments: {count} faults in {len(files)} files")
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main())
