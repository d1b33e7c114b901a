#!/usr/bin/env python3
"""Writes assets/scenes/outside/*.glb: interiors modelled by hand, which no generator of ours made.

They are a test set: no model is trained or tuned on them (assets/scenes/outside/README.md). The
rooms are functions of scripts/assets/rooms; the same bytes come out on every machine. Python's
standard library suffices.

usage: scripts/assets/make_outside_rooms.py [NAME...] [--out FOLDER] [--check] [--list]
"""
import argparse
import inspect
import pathlib
import sys

from rooms import halls, homes, places
from rooms.glb import Document

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "assets" / "scenes" / "outside"


def scenes():
    """Rooms by name: the functions of its modules that take a document alone."""
    return {name: function for module in (homes, places, halls)
            for name, function in vars(module).items()
            if inspect.isfunction(function) and function.__module__ == module.__name__
            and list(inspect.signature(function).parameters) == ["doc"]}


def written(name, function):
    doc = Document(name)
    function(doc)
    return doc.bytes()


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help="rooms (default: all)")
    parser.add_argument("--out", type=pathlib.Path, default=FOLDER,
                        help="folder (default: assets/scenes/outside of this checkout)")
    parser.add_argument("--check", action="store_true",
                        help="write nothing; fail where a file is missing or has other bytes")
    parser.add_argument("--list", action="store_true", help="print names and what each tries")
    arguments = parser.parse_args()
    known = scenes()
    unknown = [name for name in arguments.names if name not in known]
    if unknown:
        sys.exit(f"make_outside_rooms.py: {unknown[0]}: no such room; --list names them")
    chosen = {name: known[name] for name in arguments.names or known}
    if arguments.list:
        for name, function in chosen.items():
            print(f"{name}: {function.__doc__}")
        return
    differing = []
    for name, function in chosen.items():
        path, data = arguments.out / f"{name}.glb", written(name, function)
        if not arguments.check:
            arguments.out.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)
            print(f"{path}: {len(data)} bytes")
        elif not path.is_file() or path.read_bytes() != data:
            differing.append(str(path))
    if differing:
        sys.exit(f"make_outside_rooms.py: not as written: {', '.join(differing)}")


if __name__ == "__main__":
    main()
