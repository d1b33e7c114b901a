#!/usr/bin/env python3
"""Measures what the paper's tables and figures claim, a row at a time, and writes docs/paper.md.

usage: scripts/figures/paper.py --list              names the rows and what each costs
       scripts/figures/paper.py ROW ... [--quick]   measures rows (all: every row)
       scripts/figures/paper.py --table ROW         prints the table of a row that was measured
       scripts/figures/paper.py --keep ROW ...      copies rows that were measured into docs/paper
       scripts/figures/paper.py --page [--check]    writes docs/paper.md from docs/paper/*.json, or
                                                    fails where it says otherwise

  --quick     small data and short trainings: all rows in 20 minutes of two cores
  --out DIR   data, results of every command and rows (runs/paper; of --quick in its folder quick)
  --bin DIR   the programs (build/bin); experiment_paper needs -DLTE_EXPERIMENTS=ON

A row is a list of commands. The result of each is kept in DIR/ROW and is not made again while its
command line is the same, so that a stopped run goes on where it was; those of long trainings are
kept in docs/paper/trainings, so that it may be another machine. Processor seconds are those of the
commands as they ran last: scenes that an earlier, stopped one had made are not counted.
"""
import argparse
import datetime
import json
import pathlib
import resource
import shlex
import shutil
import sys
import time

from benchmarks import Fault, commit, machine, run_command
from paper_tables import page
from paper_tables.rows import ROWS

ROOT = pathlib.Path(__file__).resolve().parents[2]
TRAININGS = "docs/paper/trainings"


class Run:
    """What a row is measured with: its size, its folder and the commands that it has run."""

    def __init__(self, row, args):
        self.root, self.bin, self.quick = ROOT, args.bin, args.quick
        self.out = args.out / ("quick" if args.quick else "full")
        self.row, self.commands, self.done = row, [], {}

    def size(self, whole, quick):
        return quick if self.quick else whole

    def folder(self, name):
        """A path that commands are given, relative to the repository. Rows share what it names."""
        path = self.out / "work" / name
        (ROOT / path).parent.mkdir(parents=True, exist_ok=True)
        return str(path)

    def tool(self, label, *words, shared=False, training=False):
        """Runs a program with --json, and returns what it writes there. Rows share data that a
        shared command makes, and trainings."""
        folder = self.out / ("work" if shared or training else self.row)
        if training and not self.quick:
            folder = pathlib.Path(TRAININGS)
        path = folder / f"{label.replace(' ', '-')}.json"
        words = [self.bin / words[0], *words[1:]]
        self.run(label, [*words, "--quiet", "--json", path], path)
        return json.loads((ROOT / path).read_text())

    def script(self, label, *words):
        self.run(label, words, self.out / self.row / f"{label}.done")

    def run(self, label, words, result):
        words = [str(word) for word in words]
        shown = self.shown(words)
        note = (ROOT / result).with_suffix(".command")
        (ROOT / result).parent.mkdir(parents=True, exist_ok=True)
        if (ROOT / result).exists() and note.exists():
            known = json.loads(note.read_text())
            if self.shown(known["words"]) == shown:
                self.finish(label, shown, known)
                return
        (ROOT / result).unlink(missing_ok=True)
        clock, before = time.monotonic(), cpu_seconds()
        run_command(words, "paper")
        known = {"words": shown, "seconds": time.monotonic() - clock,
                 "cpu_seconds": cpu_seconds() - before}
        if not (ROOT / result).exists():
            (ROOT / result).write_text("")
        note.write_text(json.dumps(known))
        self.finish(label, shown, known)

    def finish(self, label, shown, known):
        self.done[label] = known
        self.commands.append(shlex.join(shown))

    def shown(self, words):
        """A command as a reader would type it."""
        program = {sys.executable: "python3"}.get(words[0], words[0])
        if program.startswith(str(self.bin)):
            program = pathlib.Path(program).name
        shown = [program, *words[1:]]
        if "--json" in shown:
            at = shown.index("--json")
            del shown[at - (shown[at - 1] == "--quiet"):at + 2]
        return shown

    def seconds(self, label):
        return self.done[label]["seconds"]

    def cpu_seconds(self, label):
        return self.done[label]["cpu_seconds"]

    def measure(self, row):
        rows = row.make(self)
        return {"row": row.name, "command": command_of(row.name, self.quick), "quick": self.quick,
                "date": datetime.date.today().isoformat(), "machine": machine(),
                "commit": commit(), "commands": self.commands,
                "seconds": sum(known["seconds"] for known in self.done.values()),
                "cpu_seconds": sum(known["cpu_seconds"] for known in self.done.values()),
                "rows": rows}


def cpu_seconds():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def command_of(name, quick=False):
    return f"scripts/figures/paper.py {name}" + (" --quick" if quick else "")


def measured(name, args):
    """The file of a row: of the whole run where there is one."""
    for kind in ("quick",) if args.quick else ("full", "quick"):
        path = ROOT / args.out / kind / f"{name}.json"
        if path.exists():
            return path
    raise Fault(f"row {name}: no run of it in {args.out}; {command_of(name, args.quick)} makes it")


def run_rows(names, args):
    for row in ROWS:
        if row.name not in names:
            continue
        run = Run(row.name, args)
        found = run.measure(row)
        path = ROOT / run.out / f"{row.name}.json"
        path.write_text(json.dumps(found, indent=1) + "\n")
        print(f"{row.name}: {row.line(found['rows'])} ({found['cpu_seconds']:.0f} CPU s)")


def parse_args():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rows", nargs="*", metavar="ROW")
    for flag in ("--quick", "--list", "--page", "--check"):
        parser.add_argument(flag, action="store_true")
    parser.add_argument("--table", metavar="ROW")
    parser.add_argument("--keep", nargs="+", default=[], metavar="ROW")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("runs/paper"))
    parser.add_argument("--bin", type=pathlib.Path, default=pathlib.Path("build/bin"))
    args = parser.parse_args()
    known = [row.name for row in ROWS]
    for name in [*args.rows, *args.keep, *([args.table] if args.table else [])]:
        if name not in known and not (name == "all" and name in args.rows):
            parser.error(f"no row {name}: expected {', '.join(known)}")
    if not (args.rows or args.list or args.page or args.table or args.keep):
        parser.error("names no row; all measures every row, --list says what there is")
    if args.check and not args.page:
        parser.error("--check: goes with --page")
    args.names = known if "all" in args.rows else args.rows
    return args


def main():
    args = parse_args()
    if args.list:
        for row in ROWS:
            print(f"{row.name:16} {row.items}\n{'':16} processor time: {row.cost} (--quick)")
    run_rows(args.names, args)
    if args.table:
        row = next(row for row in ROWS if row.name == args.table)
        print(page.table(row, json.loads(measured(row.name, args).read_text())["rows"]))
    kept = ROOT / "docs" / "paper"
    for name in args.keep:
        kept.mkdir(exist_ok=True)
        shutil.copyfile(measured(name, args), kept / f"{name}.json")
    if args.page:
        files = {ROOT / "docs" / "paper.md": page.page(kept)}
        files |= {ROOT / "docs" / "images" / name: text
                  for name, text in page.charts(kept).items()}
        for path, text in files.items():
            if not args.check:
                path.write_text(text, encoding="utf-8")
            elif text != path.read_text(encoding="utf-8"):
                raise Fault(f"{path}: differs from docs/paper: run scripts/figures/paper.py --page")


if __name__ == "__main__":
    try:
        main()
    except OSError as error:
        sys.exit(f"paper.py: {error.filename}: {error.strerror}")
    except Fault as fault:
        sys.exit(f"paper.py: {fault}")
