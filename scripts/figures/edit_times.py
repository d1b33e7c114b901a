#!/usr/bin/env python3
"""Processor seconds from an edit of a scene to the picture of its frame, and that picture's error.

usage: scripts/figures/edit_times.py [SCENE ...] [--methods M,...] [--work DIR] [--bin DIR]
                                     [--json FILE]

lte_render plays frame 0, the scene as its file is, and frame 1, the edit. Its report has no
processor seconds of a frame: what counts is how much more the run takes than one that ends with the
frame before. Short runs are repeated, and the least counts. The network encodes a lamp apart at its
first edit; another edit of the lamp in frame 2 ("again") shows what is left of the time.

The error is that of indirect light after the edit against two path-traced references, without their
noise (lte_eval pictures); references are kept in the work folder. The layers are those of a session
that begins with the edit, whose frame is the same bit for bit.
"""
import argparse
import dataclasses
import hashlib
import json
import pathlib
import statistics

from point_errors import ROOT, processor_seconds

METHODS = {f"{integrator}-{quality}": ("--integrator", integrator, "--quality", quality)
           for integrator in ("gather", "network") for quality in ("draft", "preview", "final")}
METHODS |= {f"denoised-{spp}": ("--integrator", "path", "--spp", str(spp)) for spp in (4, 16, 64)}
LONG = 3  # seconds of a run whose noise is small beside what is measured: it is not repeated
REFERENCE_SEEDS = (101, 102)  # of no method


@dataclasses.dataclass(frozen=True)
class Edit:
    """What happens in each frame from the first one on, as entries of docs/editing.md."""
    scene: str
    kind: str
    steps: tuple[tuple[dict, ...], ...]


def lamp(scene, light, *looks):
    return Edit(scene, "lamp", tuple(({"light": light, **look},) for look in looks))


def moved(scene, by, *instances):
    return Edit(scene, "object", (tuple({"instance": name, "move": by} for name in instances),))


def painted(scene, material, color):
    return Edit(scene, "material", (({"material": material, "base_color": color},),))


LIVING_ROOM, KITCHEN, FLAT = (f"assets/scenes/{name}.glb" for name in (
    "living_room", "outside/kitchen_turned", "outside/flat_hanging_panel"))
EDITS = (
    lamp(LIVING_ROOM, "ceiling light", {"gain": 0.3}, {"gain": 0.1}),
    moved(LIVING_ROOM, [-0.7, 0, 0.2], "armchair", "armchair#2", "armchair#3"),
    painted(LIVING_ROOM, "wall", [0.7, 0.2, 0.1]),
    lamp(KITCHEN, "strip 0", {"color": [1, 0.45, 0.15]}, {"color": [0.2, 0.4, 1]}),
    moved(KITCHEN, [-0.6, 0, 0.5], "chair 0"),
    painted(KITCHEN, "cream", [0.2, 0.3, 0.7]),
    lamp(FLAT, "panel", {"gain": 0.3, "color": [1, 0.45, 0.15]}, {"gain": 0.1}),
    moved(FLAT, [0.6, 0, 0], "low table"),
    painted(FLAT, "parquet", [0.5, 0.15, 0.1]),
)


def script(steps, first=1):
    """The text of a file that ends with the frame of the last of these steps."""
    entries = [{**entry, "frame": first + k} for k, step in enumerate(steps) for entry in step]
    return f"frames: {first + len(steps)}\nedits: {json.dumps(entries)}\n"


def render(args, scene, text, out, *flags):
    """Processor seconds of a run of the script `text`."""
    file = args.work / "edits.yaml"
    file.write_text(text)
    for old in args.work.glob(out.replace("%d", "*")):
        old.unlink()
    return processor_seconds([args.bin / "lte_render", ROOT / scene, "--edit", file, "--out",
                              args.work / out, "--size", args.size, "--threads", "1", "--quiet",
                              *flags])


def least_seconds(args, scene, steps, flags):
    spent = []
    while len(spent) < args.repeats and (not spent or spent[-1] < LONG):
        spent.append(render(args, scene, script(steps), "frame_%d.png", *flags))
    return min(spent)


def reference(args, edit, seed):
    """A path-traced picture of the scene after the edit."""
    text = script(edit.steps[:1], first=0)
    named = hashlib.sha1(f"{edit.scene} {args.size} {args.paths} {text}".encode()).hexdigest()[:12]
    name = f"{pathlib.Path(edit.scene).stem}-{named}-{seed}.exr"
    if not (args.work / name).exists():
        render(args, edit.scene, text, "partial.exr", "--integrator", "path", "--spp",
               str(args.paths), "--set", "denoise=off", "--seed", str(seed))
        (args.work / "partial.exr").rename(args.work / name)
    return args.work / name


def score(args, picture, references):
    """What lte_eval says of the indirect light of a picture."""
    result = args.work / "score.json"
    both = [word for path in references for word in ("--reference", path)]
    processor_seconds([args.bin / "lte_eval", "pictures", picture, *both, "--layer", "indirect",
                       "--quiet", "--json", result])
    [found] = json.loads(result.read_text())
    return found


def measure(args, edit, before):
    """By method seconds and error, and the noise of a reference.

    @param before  by scene and method the seconds of runs of frame 0 alone, which edits share
    """
    out, noise = {}, None
    references = [reference(args, edit, seed) for seed in REFERENCE_SEEDS]
    for name in args.methods:
        flags = METHODS[name]
        if (edit.scene, name) not in before:
            before[edit.scene, name] = least_seconds(args, edit.scene, (), flags)
        spent = [before[edit.scene, name]]
        steps = edit.steps if name.startswith("network") else edit.steps[:1]
        spent += [least_seconds(args, edit.scene, steps[:k + 1], flags) for k in range(len(steps))]
        out[name] = {"seconds": spent[1] - spent[0]}
        if len(spent) > 2:
            out[name]["again"] = spent[2] - spent[1]
        # A .png above, as denoised paths take longer to be denoised in layers.
        render(args, edit.scene, script(edit.steps[:1], first=0), "layers.exr", *flags)
        found = score(args, args.work / "layers.exr", references)
        out[name]["error"], noise = found["error"], found["noise"]
    return out, noise


def summary(name, edits):
    of = [edit["methods"][name] for edit in edits]
    return {"method": name, "seconds": statistics.fmean(f["seconds"] for f in of),
            "error": statistics.geometric_mean(f["error"] for f in of)}


def parse_args():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    scenes = list(dict.fromkeys(pathlib.Path(edit.scene).stem for edit in EDITS))
    parser.add_argument("scenes", nargs="*", help=f"of {', '.join(scenes)}; by default all")
    parser.add_argument("--methods", default=",".join(METHODS), help="by default %(default)s")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "out/benchmarks/edits")
    parser.add_argument("--bin", type=pathlib.Path, default=ROOT / "build/bin")
    parser.add_argument("--size", default="128x96")
    parser.add_argument("--paths", type=int, default=512, help="a pixel of half a reference")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--json", type=pathlib.Path)
    args = parser.parse_args()
    args.methods = args.methods.split(",")
    for what, names, known in (("scene", args.scenes, scenes), ("method", args.methods, METHODS)):
        for name in names:
            if name not in known:
                parser.error(f"no {what} {name}: expected {', '.join(known)}")
    args.scenes = args.scenes or scenes
    return args


def main():
    args = parse_args()
    args.work.mkdir(parents=True, exist_ok=True)
    edits, before = [], {}
    for edit in EDITS:
        scene = pathlib.Path(edit.scene)
        if scene.stem not in args.scenes:
            continue
        methods, noise = measure(args, edit, before)
        edits.append({"scene": scene.name, "edit": edit.kind, "noise": noise,
                      "methods": methods})
        print(f"{scene.name}, {edit.kind}:",
              *(f"{name} {row['seconds']:.2f} s {100 * row['error']:.1f} %"
                for name, row in methods.items()), flush=True)
    methods = [summary(name, edits) for name in args.methods]
    result = {"size": args.size, "paths": args.paths, "edits": edits, "methods": methods}
    if args.json:
        args.json.write_text(json.dumps(result, indent=1) + "\n")
    for method in methods:
        print(f"{method['method']}: {method['seconds']:.2f} processor seconds, "
              f"{100 * method['error']:.1f} % off")


if __name__ == "__main__":
    main()
