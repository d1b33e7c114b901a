#!/usr/bin/env python3
"""Trains variants of a configuration for equal times with several seeds, and prints a table of
their validation errors.

  experiments/ablation/ablate.py --config configs/train/demo.yaml --data data/demo --seconds 300 \\
      --seeds 1 2 3 --out out/ablation \\
      --variant "as it is" --variant "no rotation: augment.rotate=none" \\
      --variant "no mirror: augment.mirror=false"

A variant is a name, and after a colon the keys it sets. Equal time is equal training time on this
machine: the first steps of each variant are timed, and train.steps is what fits into --seconds, so
that every schedule runs to its end. Time the runs on a machine that does nothing else. Where that
cannot be, --clock cpu counts the processor time of the process instead, which --threads 1 makes the
time that one core of its own would take. Figures are those of the last step on the validation
split; the spread is the standard deviation over seeds. Runs that are there already are not run
again, so the same command goes on after a stop.
"""
import argparse
import json
import pathlib
import resource
import shutil
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
METRICS = ("val_loss", "val_mse", "val_psnr")


def fail(message: str) -> None:
    print(f"ablate.py: {message}", file=sys.stderr)
    raise SystemExit(1)


def parse_variant(text: str) -> tuple[str, list[str]]:
    name, _, keys = text.partition(":")
    settings = keys.split()
    for setting in settings:
        if "=" not in setting:
            fail(f'--variant "{text}": "{setting}" is not key=value')
    if not name.strip():
        fail(f'--variant "{text}": has no name')
    return name.strip(), settings


def cpu_seconds() -> float:
    """Processor time of all runs that have ended."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def train(args, settings: list[str], seed: int, out: pathlib.Path, result: pathlib.Path,
          more: list[str]) -> dict:
    """Runs lte_train. Returns its --json result and the processor time that it took."""
    command = [args.tool, "--config", args.config, "--out", str(out), "--seed", str(seed),
               "--quiet", "--json", str(result)]
    for setting in [f"data.root={args.data}", *settings]:
        command += ["--set", setting]
    if args.threads:
        command += ["--threads", str(args.threads)]
    before = cpu_seconds()
    done = subprocess.run(command + more, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        reason = done.stderr.strip() or f"exit code {done.returncode}"
        fail(f"{' '.join(command + more)}: {reason}")
    return json.loads(result.read_text()) | {"cpu_seconds": cpu_seconds() - before}


def steps_in_time(args, name: str, settings: list[str], folder: pathlib.Path) -> int:
    """Steps of this variant that fit into --seconds; timed once."""
    known = folder / "steps.json"
    if known.exists():
        return json.loads(known.read_text())["steps"]
    warm, timed = args.timing_steps, 3 * args.timing_steps
    seconds = []
    for count in (warm, timed):  # their difference is free of what only the first steps cost
        out = folder / f"timing{count}"
        shutil.rmtree(out, ignore_errors=True)
        endless = [*settings, "train.steps=1000000000", "train.warmup_steps=0"]
        run = train(args, endless, 1, out, folder / "timing.json", ["--stop-after", str(count)])
        seconds.append(run["cpu_seconds" if args.clock == "cpu" else "seconds"])
        shutil.rmtree(out)
    each = (seconds[1] - seconds[0]) / (timed - warm)
    if each <= 0:
        fail(f"variant {name}: {timed} steps took {seconds[1]:.2f} s and {warm} steps "
             f"{seconds[0]:.2f} s: raise --timing-steps")
    steps = max(1, round(args.seconds / each))
    known.write_text(json.dumps({"steps": steps, "seconds_a_step": each}))
    return steps


def run_variant(args, name: str, settings: list[str]) -> list[dict]:
    folder = args.out / "".join(c if c.isalnum() else "_" for c in name)
    folder.mkdir(parents=True, exist_ok=True)
    what = folder / "settings.json"
    now = {"config": args.config, "data": args.data, "seconds": args.seconds, "settings": settings}
    if what.exists() and json.loads(what.read_text()) != now:
        fail(f"{folder}: holds runs of other settings ({what}); choose another --out")
    what.write_text(json.dumps(now))
    steps = steps_in_time(args, name, settings, folder)
    results = []
    for seed in args.seeds:
        result = folder / f"seed{seed}.json"
        if not (result.exists() and json.loads(result.read_text()).get("finished")):
            run = folder / f"seed{seed}"
            resume = ["--resume"] if (run / "checkpoint.safetensors").exists() else []
            more = [f"train.steps={steps}", f"train.validate_every={steps}",
                    f"train.warmup_steps={min(args.warmup, steps // 10)}"]
            train(args, [*settings, *more], seed, run, result, resume)
        results.append(json.loads(result.read_text()))
        last = results[-1]
        print(f"{name}, seed {seed}: {last['step']} steps, {last['seconds']:.0f} s, " +
              ", ".join(f"{metric} {last[metric]:.4g}" for metric in METRICS), file=sys.stderr)
    return results


def cell(values: list[float], digits: int) -> str:
    spread = f" ± {statistics.stdev(values):.{max(1, digits - 2)}g}" if len(values) > 1 else ""
    return f"{statistics.mean(values):.{digits}g}{spread}"


def table(rows: list[tuple[str, list[dict]]]) -> str:
    lines = ["| variant | seeds | steps | seconds | loss | MSE | PSNR, dB |",
             "|---|---:|---:|---:|---:|---:|---:|"]
    for name, results in rows:
        seconds = statistics.mean(result["seconds"] for result in results)
        errors = [cell([result[metric] for result in results], 4) for metric in METRICS]
        row = [name, str(len(results)), str(results[0]["step"]), f"{seconds:.0f}", *errors]
        lines.append(f"| {' | '.join(row)} |")
    return "\n".join(lines) + "\n"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--config", required=True, help="YAML file that the variants differ from")
    parser.add_argument("--data", required=True, help="data set with a validation split")
    parser.add_argument("--out", required=True, type=pathlib.Path,
                        help="folder for runs, results.json and table.md")
    parser.add_argument("--variant", action="append", required=True,
                        metavar='"NAME: KEY=VALUE ..."', help="may be repeated")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3])
    parser.add_argument("--seconds", type=float, required=True, help="training time of each run")
    parser.add_argument("--warmup", type=int, default=50,
                        help="train.warmup_steps, at most a tenth of the steps")
    parser.add_argument("--timing-steps", type=int, default=20,
                        help="steps that are timed, and three times as many")
    parser.add_argument("--threads", type=int, default=0)
    parser.add_argument("--clock", choices=("wall", "cpu"), default="wall",
                        help="what --seconds counts")
    parser.add_argument("--tool", default=str(ROOT / "build/bin/lte_train"))
    args = parser.parse_args()
    variants = [parse_variant(text) for text in args.variant]
    if len({name for name, _ in variants}) < len(variants):
        fail("two variants have one name")
    if args.clock == "cpu" and args.threads != 1:
        fail("--clock cpu: needs --threads 1, or more threads would count as more time")
    if args.seconds <= 0 or args.timing_steps < 1:
        fail("--seconds and --timing-steps: expected positive numbers")
    args.out.mkdir(parents=True, exist_ok=True)
    rows = [(name, run_variant(args, name, settings)) for name, settings in variants]
    (args.out / "results.json").write_text(json.dumps(dict(rows), indent=1))
    text = table(rows)
    (args.out / "table.md").write_text(text)
    print(text, end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
