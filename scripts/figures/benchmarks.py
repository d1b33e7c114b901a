#!/usr/bin/env python3
"""Writes tables and charts of docs/benchmarks.md from docs/benchmarks/*.json, and measures them.

usage: scripts/figures/benchmarks.py                      the page, from the files that there are
       scripts/figures/benchmarks.py --run [TABLE ...]    runs the commands of tables first (all)
       scripts/figures/benchmarks.py --check              fails where the page says otherwise
       scripts/figures/benchmarks.py --list               names the tables and their commands

  --resume         commands that can go on where an earlier run stopped
  --bin DIR        the programs (build/bin); lte_ops_microbench is built by the preset ci
  --work DIR       what the commands write and read again (out/benchmarks)
  --machine TEXT   the machine, where /proc/cpuinfo does not say enough
  --docs DIR       the folder of benchmarks.md (docs)

Run it on a machine that does nothing else: all tables take about an hour of two cores. Figures are
the least of a command's repeats. A table's file holds its rows, commands, date, machine and commit,
and is written when all its commands have ended well.
"""
import argparse
import datetime
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import textwrap

from benchmark_charts import charts
from benchmark_tables import TABLES

ROOT = pathlib.Path(__file__).resolve().parents[2]
BEGIN, END = "<!-- table {name} -->", "<!-- end -->"
COLUMNS = 100


class Fault(Exception):
    """What ends the program with one line."""


def number(value):
    """Three digits that count; text as it is; nothing for None."""
    if value is None or isinstance(value, str):
        return value or ""
    value = float(f"{value:.3g}")
    return f"{value:,.0f}" if value == int(value) else f"{value:.7f}".rstrip("0")


def field(row, key):
    for part in key.split("."):
        row = (row or {}).get(part)
    return row


def wrapped(command):
    """A command in lines; a flag stays beside its value where that has room."""
    room = COLUMNS - 6  # four columns before all lines but the first, " \\" behind all but the last
    lines = [""]
    for flag in re.split(r" (?=--)", command):
        for part in [flag] if len(flag) <= room else flag.split(" "):
            if lines[-1] and len(lines[-1]) + len(part) >= room:
                lines.append("")
            lines[-1] += f" {part}" if lines[-1] else part
    return " \\\n    ".join(lines).split("\n")


def markdown(table, file):
    origin = f"*{file['date']}, {file['machine']}.* {file.get('note', '')}"
    lines = textwrap.wrap(origin, COLUMNS) + [""]
    # check_readme.py holds the flags of tools to their help; not every build has microbenchmarks.
    checked = not any("microbench" in command for command in file["commands"])
    lines.append("```sh no-run" if checked else "```text")
    lines += [line for command in file["commands"] for line in wrapped(command)] + ["```"]
    # A column that no row has is of a command that has not run.
    columns = [(head, key) for head, key in table.columns
               if any(field(row, key) is not None for row in file["rows"])]
    rows = [[number(field(row, key)) for _, key in columns] for row in file["rows"]]
    lines += ["", f"| {' | '.join(head for head, _ in columns)} |",
              "|---|" + "---:|" * (len(columns) - 1)]
    lines += [f"| {' | '.join(row)} |" for row in rows]
    return "\n".join(lines)


def read_json(path):
    try:
        text = path.read_text(encoding="utf-8")
        return [json.loads(line) for line in text.splitlines() if line.strip()] \
            if path.suffix == ".jsonl" else json.loads(text)
    except ValueError as error:
        raise Fault(f"{path}: is no JSON: {error}") from error


def page_with_tables(docs):
    page = (docs / "benchmarks.md").read_text(encoding="utf-8")
    for table in TABLES:
        begin = BEGIN.format(name=table.name)
        file = docs / "benchmarks" / f"{table.name}.json"
        if not file.exists():
            continue
        head, found, rest = page.partition(begin)
        _, ended, tail = rest.partition(END)
        if not found or not ended:
            raise Fault(f"{docs / 'benchmarks.md'}: has no {begin} ... {END}")
        try:
            body = markdown(table, read_json(file))
        except KeyError as missing:
            raise Fault(f"{file}: has no {missing}") from missing
        page = f"{head}{begin}\n{body}\n{END}{tail}"
    return page


def machine():
    """The processor, its cores and the instructions that decide the kernels."""
    info = pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8")
    facts = dict(line.split(":", 1) for line in info.splitlines() if ":" in line)
    facts = {key.strip(): value.strip() for key, value in facts.items()}
    flags = set(facts.get("flags", "").split())
    isa = next((words for flag, words in (("amx_bf16", "AMX"), ("avx512_bf16", "AVX512-BF16"),
                                          ("avx512f", "AVX-512"), ("avx2", "AVX2"))
                if flag in flags), "neither AVX2 nor AVX-512")
    return f"{os.cpu_count()} cores of {facts.get('model name', 'a processor')} ({isa})"


def commit():
    git = subprocess.run(["git", "-C", ROOT, "rev-parse", "HEAD"], capture_output=True, text=True,
                         check=False)
    return git.stdout.strip() if git.returncode == 0 else None


def run_command(words, program="benchmarks"):
    print(f"{program}:", shlex.join(words), file=sys.stderr, flush=True)
    try:
        done = subprocess.run(words, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                              text=True, check=False)
    except OSError as error:
        raise Fault(f"{words[0]}: {error.strerror}: build it, or name its folder by --bin") \
            from error
    if done.returncode != 0:
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        raise Fault(f"{pathlib.Path(words[0]).name} ended with {done.returncode}: {last}")


def measure(table, args):
    results, shown = {}, []
    for command in table.commands:
        path = pathlib.Path(command.json.format(work=args.work, table=table.name,
                                                label=command.label))
        names = {"work": str(args.work), "json": str(path)}
        words = [word.format(**names) for word in command.line.split()]
        goes_on = args.resume and command.line.startswith("lte_bench bake ")
        if path.suffix == ".jsonl":
            shutil.rmtree(ROOT / path.parent, ignore_errors=True)  # a run goes into no old folder
        run_command([words[0] if "/" in words[0] else str(args.bin / words[0]), *words[1:],
                     *(["--resume"] if goes_on else [])])
        if command.label:
            results[command.label] = read_json(ROOT / path)
        shown.append(shlex.join(word for word in words if word not in ("--json", str(path))))
    try:
        rows = table.rows(results)
    except (KeyError, StopIteration) as missing:
        raise Fault(f"table {table.name}: its results have no {missing}") from missing
    return {"date": datetime.date.today().isoformat(), "machine": args.machine or machine(),
            "commit": commit(), "commands": shown, "rows": rows}


def parse_args():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--run", nargs="*", metavar="TABLE")
    parser.add_argument("--resume", action="store_true")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--bin", type=pathlib.Path, default=ROOT / "build" / "bin")
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("out/benchmarks"))
    parser.add_argument("--machine")
    parser.add_argument("--docs", type=pathlib.Path, default=ROOT / "docs")
    args = parser.parse_args()
    names = [table.name for table in TABLES]
    for name in args.run or ():
        if name not in names:
            parser.error(f"no table {name}: expected {', '.join(names)}")
    return args


def main():
    args = parse_args()
    if args.list:
        for table in TABLES:
            print(table.name, *(f"    {command.line}" for command in table.commands), sep="\n")
        return
    if args.run is not None:
        (ROOT / args.work).mkdir(parents=True, exist_ok=True)
        (args.docs / "benchmarks").mkdir(exist_ok=True)
        for table in TABLES:
            if not args.run or table.name in args.run:
                text = json.dumps(measure(table, args), indent=1, ensure_ascii=False) + "\n"
                (args.docs / "benchmarks" / f"{table.name}.json").write_text(text, encoding="utf-8")
    written = {args.docs / "benchmarks.md": page_with_tables(args.docs), **charts(args.docs)}
    for path, text in written.items():
        if not args.check:
            path.parent.mkdir(exist_ok=True)
            path.write_text(text, encoding="utf-8")
        elif not path.exists() or text != path.read_text(encoding="utf-8"):
            raise Fault(f"{path}: differs from its files: run scripts/figures/benchmarks.py")


if __name__ == "__main__":
    try:
        main()
    except OSError as error:
        sys.exit(f"benchmarks.py: {error.filename}: {error.strerror}")
    except Fault as fault:
        sys.exit(f"benchmarks.py: {fault}")
