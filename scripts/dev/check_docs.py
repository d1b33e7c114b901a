#!/usr/bin/env python3
"""Fails where a document names a file that is not there, or holds a line too long to read.

usage: scripts/dev/check_docs.py [ROOT]

Looked at are README.md, CHANGELOG.md, CONTRIBUTING.md, SECURITY.md, docs/ and
assets/models/README.md:
- every relative link leads to a file, and its #anchor to a heading of it;
- every path in `code` that begins with a folder of the repository exists, * and {a,b} expanded;
- every page of docs/ is in the index of its folder;
- lines have at most 100 columns, tables and pictures apart.
"""

import glob
import itertools
import pathlib
import re
import sys

COLUMNS = 100
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
CODE = re.compile(r"`([^`]+)`")
FOLDERS = "assets|cmake|configs|datagen|docs|examples|infer|lte|scripts|tests|train"
PATH = re.compile(rf"(?<![\w/.-])((?:{FOLDERS})/[\w./*{{}},-]*\w[\w*}}]*)")
# What a run of a tool makes, and a name that stands for any.
PLACEHOLDER = re.compile(r"NAME|\.\.\.|\bscenes/[a-z]*\*|manifest|scene/fbx|train/(loss|lr)$")


def pages(root: pathlib.Path) -> list[pathlib.Path]:
    names = ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md",
             "assets/models/README.md")
    return [root / name for name in names] + sorted((root / "docs").rglob("*.md"))


def without_code(text: str) -> str:
    return re.sub(r"^```.*?^```", lambda m: "\n" * m.group(0).count("\n"), text, flags=re.M | re.S)


def anchors(page: pathlib.Path) -> set[str]:
    """The names that GitHub gives the headings of a page."""
    out = set()
    for line in without_code(page.read_text()).splitlines():
        if heading := re.match(r"#+\s+(.*)", line):
            text = re.sub(r"[^\w\s-]", "", heading.group(1).strip().lower())
            out.add(re.sub(r"\s", "-", text))
    return out


def expansions(pattern: str):
    """`a/{b,c}.h` as `a/b.h` and `a/c.h`."""
    parts = re.split(r"\{([^}]*)\}", pattern)
    choices = [part.split(",") if i % 2 else [part] for i, part in enumerate(parts)]
    return ("".join(words) for words in itertools.product(*choices))


def link_faults(root: pathlib.Path, page: pathlib.Path, text: str):
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("    "):
            continue
        for target in LINK.findall(line):
            if re.match(r"[a-z]+:", target):
                continue
            name, _, anchor = target.partition("#")
            file = (page.parent / name).resolve() if name else page
            if not file.exists():
                yield number, f"the link to {target} leads nowhere"
            elif anchor and file.suffix == ".md" and anchor not in anchors(file):
                yield number, f"{name or page.name} has no heading #{anchor}"


def path_faults(root: pathlib.Path, text: str):
    for number, line in enumerate(text.splitlines(), 1):
        spans = [line] if line.startswith("    ") else CODE.findall(line)
        for path in itertools.chain.from_iterable(PATH.findall(span) for span in spans):
            if PLACEHOLDER.search(path):
                continue
            for name in expansions(path.rstrip(".,/")):
                if not glob.glob(str(root / name)) and not glob.glob(str(root / name) + ".*"):
                    yield number, f"{name} does not exist"


def line_faults(text: str):
    for number, line in enumerate(text.splitlines(), 1):
        if len(line) > COLUMNS and not line.lstrip().startswith(("|", "![")):
            yield number, f"{len(line)} columns, at most {COLUMNS}"


def index_faults(root: pathlib.Path):
    for folder in (root / "docs", root / "docs" / "lab"):
        index = folder / "README.md"
        linked = {
            (folder / target.partition("#")[0]).resolve()
            for target in LINK.findall(index.read_text())
        }
        for page in sorted(folder.glob("*.md")):
            if page != index and page.resolve() not in linked:
                yield index, 1, f"{page.name} is not in the index"


def faults(root: pathlib.Path):
    for page in pages(root):
        text = page.read_text()
        found = itertools.chain(
            link_faults(root, page, text), path_faults(root, text), line_faults(text)
        )
        for number, fault in sorted(found):
            yield page, number, fault
    yield from index_faults(root)


def main() -> int:
    default = pathlib.Path(__file__).resolve().parents[2]
    root = pathlib.Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else default
    found = list(faults(root))
    for page, number, fault in found:
        print(f"{page.relative_to(root)}:{number}: {fault}")
    print(f"docs: {len(found)} faults in {len(pages(root))} pages")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
