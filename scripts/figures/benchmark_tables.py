"""The tables of docs/benchmarks.md: the commands behind each, the rows that their JSON gives, and
the columns. scripts/figures/benchmarks.py runs the commands and writes the page."""
import dataclasses
import math
import statistics
import typing

LIVING_ROOM = "assets/scenes/living_room.glb"
CORNELL_BOX = "assets/scenes/cornell_box.glb"
MODELS = "assets/models"


@dataclasses.dataclass(frozen=True)
class Command:
    """A command line: a program of the build, or a script by its path. {json} is the file that it
    writes, {work} a folder that is kept; a command without {json} prepares the others. `json` names
    another file that holds its result."""
    line: str
    label: str = ""
    json: str = "{work}/{table}-{label}.json"


@dataclasses.dataclass(frozen=True)
class Table:
    name: str
    commands: tuple[Command, ...]
    rows: typing.Callable[[dict], list[dict]]  # results by label -> what the table's file keeps
    columns: tuple[tuple[str, str], ...]  # heading, dotted key of a row


def whole_pictures(figures):
    """FLIP, SSIM, and MSE over the squared mean: means over scenes, of the errors geometric."""
    if not figures:
        return {}
    # An error below the reference's noise counts as that noise.
    errors = [max(f["mse"], f["mse_stderr"]) / f["mean"] ** 2 for f in figures]
    return {"flip": statistics.fmean(f["flip"] for f in figures),
            "ssim": statistics.fmean(f["ssim"] for f in figures),
            "mse": math.exp(statistics.fmean(map(math.log, errors)))}


def outside_rows(results):
    scenes = results["scenes"]["scenes"]
    rows = []
    for method in results["scenes"]["methods"]:
        figures = [scene["methods"][method["name"]] for scene in scenes
                   if "irradiance" in scene["methods"].get(method["name"], {})]
        ratios = [f["irradiance"]["mean_ratio"] for f in figures]
        rows.append({"method": method["name"], "rooms": method["of"], "right": method["right"],
                     "mean_within": sum(r is not None and abs(r - 1) <= 0.05 for r in ratios),
                     "worth": method["worth"]["geometric_mean"],
                     "least": method["worth"]["least"],
                     "whole": whole_pictures([f["whole"] for f in figures]),
                     "cpu_seconds": method["processor_seconds_median"]})
    return rows


def point_rows(results):
    """By integrator the figures of its last run, with the program's own rays, and of all runs."""
    rows = {}
    for run in results["probe"]["methods"]:
        figures = {"rays": run["rays"], "error": run["error"],
                   "cpu_seconds": run["processor_seconds"]}
        row = rows.setdefault(run["integrator"], {"runs": []})
        row.update({"method": run["integrator"], "rooms": len(results["probe"]["scenes"]),
                    **figures, "worth": run["worth"], "least": run["least"],
                    "mean_within": run["mean_within"]})
        row["runs"].append(figures)
    return list(rows.values())


def picture_rows(results):
    """A row a method, with the figures of each scene under its name."""
    rows = {}
    for label, result in results.items():
        for chart in result["charts"]:
            for row in chart["rows"]:
                name = row["name"] if label == "plain" else f"{row['name']}, {label}"
                figures = {"first": row["seconds_of_views"]["1"],
                           "further": row["view"]["seconds"],
                           "relmse": row["whole"]["own_relmse"], "flip": row["whole"]["flip"]}
                rows.setdefault(name, {"method": name})[chart["scene"]] = figures
    return list(rows.values())


def edit_rows(results):
    """By method mean seconds of each kind of edit, and the error over all edits."""
    measured = results["edits"]["edits"]
    rows = []
    for method in results["edits"]["methods"]:
        of = [{**{key: edit[key] for key in ("scene", "edit", "noise")},
               **edit["methods"][method["method"]]} for edit in measured]
        seconds = {kind: statistics.fmean(f["seconds"] for f in of if f["edit"] == kind)
                   for kind in dict.fromkeys(f["edit"] for f in of)}
        again = [f["again"] for f in of if "again" in f]
        rows.append({"method": method["method"], **seconds,
                     "again": statistics.fmean(again) if again else None,
                     "cpu_seconds": method["seconds"], "error": method["error"], "edits": of})
    return rows


def bake_figures(rows):
    """Means over scenes, of the errors geometric; the worst seam."""
    if not rows:
        return {}
    seams = [row["seam"] for row in rows if row["seam"] is not None]
    return {"processor_seconds": statistics.fmean(row["processor_seconds"] for row in rows),
            # Two halves of a reference leave an error that is as good as none a little below 0.
            "rel_mse": math.exp(statistics.fmean(math.log(max(row["rel_mse"], 1e-4))
                                                 for row in rows)),
            "leak": statistics.fmean(row["leak"] for row in rows),
            "seam": max(seams, default=None)}


def bake_rows(results):
    rows = {}
    for label, result in results.items():
        for row in result["scenes"]:
            rows.setdefault(row["method"], {}).setdefault(label, []).append(row)
    return [{"method": method,
             "living_room": bake_figures([r for r in of["bake"] if r["scene"] == LIVING_ROOM]),
             "others": bake_figures([r for r in of["bake"] if r["scene"] != LIVING_ROOM]),
             "all": bake_figures(of["bake"]), "million": bake_figures(of.get("million")),
             "scenes": of}
            for method, of in rows.items()]


def network_rows(results):
    words = {"encode": "encode a scene", "decode": "decode a picture"}
    return [{"work": words[run["name"]], "items": run["n"],
             "precision": run["precision"], "seconds": run["seconds_min"],
             "gflops": run["gemm_gflops_measured"], "multiple": run["times_gemm_limit"],
             "mib": run["rss_above_model_mb"]}
            for result in results.values() for run in result if run["name"] in words]


OPERATORS = {
    "Knn/camera_262144_in_5000/real_time": "kNN, k = 32, 262,144 camera hits in 5,000 points",
    "Flann/camera_262144_in_5000/real_time": "the same by FLANN",
    "Knn/shuffled_262144_in_5000/real_time": "kNN, 262,144 points in random order in 5,000",
    "Knn/scene_20000_in_20000/real_time": "kNN, 20,000 in 20,000",
    "Flann/scene_20000_in_20000/real_time": "the same by FLANN",
    "FarthestPoint/20000/real_time": "farthest point sampling, 20,000 to 10,000",
    "FarthestPoint/200000/real_time": "farthest point sampling, 200,000 to 100,000",
    "SubmanifoldConv/forward/3/real_time": "submanifold convolution 3³, 128 to 128, 5,000 points",
    "SubmanifoldConv/forward/5/real_time": "the same, 5³",
}
TO_MS = {"ns": 1e-6, "us": 1e-3, "ms": 1.0, "s": 1e3}


def operator_rows(results):
    found = {run["name"]: run["real_time"] * TO_MS[run["time_unit"]]
             for run in results["ops"]["benchmarks"]}
    return [{"work": words, "ms": found[name]} for name, words in OPERATORS.items()
            if name in found]


def path_rows(results):
    return [{"scene": scene.replace("_", " "), "rate": run["mrays_per_s"]}
            for scene, runs in results.items()
            for run in runs if run["name"] == "pathtrace irradiance"]


def training_rows(results):
    rows = []
    for label, log in results.items():
        first = next(line for line in log if "queries_per_s" in line)
        rows.append({"run": label, "queries": first["queries_per_s"], "mib": first["rss_mb"]})
    return rows


def scene_columns(scenes, keys):
    return tuple((f"{title}: {head}", f"{scene}.{key}")
                 for scene, title in scenes for key, head in keys)


def training(label, flags):
    return Command(
        "lte_train --config configs/train/demo.yaml --set data.root={work}/training-data "
        "--set data.solved_light={work}/training-light --set train.steps=42 "
        "--set train.warmup_steps=2 --set train.log_every=40 --threads 2 "
        f"--out {{work}}/training-{label} {flags}".rstrip(),
        label, "{work}/training-{label}/log.jsonl")


def pareto(label, scenes, size, methods, model=None):
    line = (f"lte_bench pareto {scenes} --size {size} --views 1 --repeats 1 --reference-spp 512 "
            f"--references {{work}}/references --methods {methods} --json {{json}}")
    return Command(line + (f" --checkpoint {MODELS}/{model}.safetensors" if model else ""), label)


def bake(label, scenes, texels):
    return Command(f"lte_bench bake {scenes} --texels {texels} --measured 8000 "
                   "--reference-paths 1024 --cycles {work}/cycles/bin/python --json {json}", label)


HOMES = Command("lte_datagen generate --config assets/data/homes-test/config.yaml --scenes 2 "
                "--glb --resume --out {work}/homes")

TABLES = (
    Table("outside", (
        Command("lte_eval scenes assets/scenes/outside --size 128x96 --report {work}/outside "
                "--json {json}", "scenes"),),
          outside_rows,
          (("method", "method"), ("rooms", "rooms"), ("right", "right"),
           ("mean within 5 %", "mean_within"), ("spp, geometric mean", "worth"),
           ("least", "least"), ("whole picture: MSE / mean²", "whole.mse"), ("FLIP", "whole.flip"),
           ("SSIM", "whole.ssim"), ("CPU s", "cpu_seconds"))),
    Table("points", (
        Command("scripts/figures/point_errors.py assets/scenes/outside --work {work}/points "
                "--json {json}", "probe"),),
          point_rows,
          (("--integrator", "method"), ("rooms", "rooms"), ("mean within 5 %", "mean_within"),
           ("samples a point, geometric mean", "worth"), ("least", "least"),
           ("CPU s", "cpu_seconds"))),
    Table("pictures", (
        pareto("plain", f"{LIVING_ROOM} {CORNELL_BOX}", "320x240", "denoised,gather,network"),),
          picture_rows,
          (("method", "method"),) + scene_columns(
              (("living_room", "living room"), ("cornell_box", "Cornell box")),
              (("first", "first view, s"), ("further", "further, s"), ("relmse", "relMSE"),
               ("flip", "FLIP")))),
    Table("edits", (
        Command("scripts/figures/edit_times.py --work {work}/edits --json {json}", "edits"),),
          edit_rows,
          (("method", "method"), ("lamp: s", "lamp"), ("again", "again"), ("object", "object"),
           ("material", "material"), ("error", "error"))),
    Table("budgets", (
        HOMES,
        pareto("plain",
               f"{LIVING_ROOM} {CORNELL_BOX} {{work}}/homes/scenes/home_00000.glb "
               "{work}/homes/scenes/home_00001.glb", "640x480",
               "gather-draft,time,denoised-1,denoised-4,denoised-16,denoised-64")),
          picture_rows,
          (("method", "method"),) + scene_columns(
              (("living_room", "living room"), ("cornell_box", "Cornell box"),
               ("home_00000", "home 0"), ("home_00001", "home 1")),
              (("first", "s"), ("relmse", "relMSE")))),
    Table("bake", (
        HOMES,
        Command("/usr/bin/env python3 -m venv {work}/cycles"),
        Command("{work}/cycles/bin/python -m pip install --quiet bpy==4.5.3"),
        bake("bake", " ".join((LIVING_ROOM, "{work}/homes/scenes/home_00000.glb",
                               "{work}/homes/scenes/home_00001.glb",
                               *(f"assets/scenes/outside/{name}.glb" for name in (
                                   "gallery_spots", "stairwell_two_floors",
                                   "dining_paper_shade")))), 256000),
        bake("million", LIVING_ROOM, 1000000)),
          bake_rows,
          (("method", "method"),) + scene_columns(
              (("living_room", "living room"), ("others", "others"),
               ("million", "1 M")), (("processor_seconds", "s"), ("rel_mse", "relMSE")))
          + (("leak", "all.leak"), ("seam", "all.seam"))),
    Table("network", (
        Command("lte_bench encoder --repeats 5 --json {json}", "encode"),
        Command("lte_bench encoder --repeats 5 --precision bf16 --json {json}", "encode-bf16"),
        Command("lte_bench decoder --repeats 3 --json {json}", "decode"),
        Command("lte_bench decoder --repeats 3 --precision bf16 --json {json}", "decode-bf16")),
          network_rows,
          (("work", "work"), ("points", "items"), ("precision", "precision"),
           ("seconds", "seconds"), ("products, GFLOP/s", "gflops"),
           ("times the products alone", "multiple"), ("MiB above the model", "mib"))),
    Table("operators", (
        Command("lte_ops_microbench --benchmark_filter=Knn|Flann|FarthestPoint|SubmanifoldConv "
                "--benchmark_out={json} --benchmark_out_format=json", "ops"),),
          operator_rows, (("work", "work"), ("ms", "ms"))),
    Table("paths", (
        Command("lte_bench pathtrace --json {json}", "Cornell_box"),
        Command(f"lte_bench pathtrace --scene {LIVING_ROOM} --json {{json}}", "living_room")),
          path_rows,
          (("scene", "scene"), ("million rays/s", "rate"))),
    Table("training", (
        Command("lte_datagen generate --config configs/data/demo.yaml --scenes 40 "
                "--resume --out {work}/training-data"),
        training("solve", ""),  # finds the light that the others read
        training("float32", ""),
        training("bfloat16", "--set train.autocast=bf16")),
          lambda results: training_rows({k: v for k, v in results.items() if k != "solve"}),
          (("run", "run"), ("queries/s", "queries"), ("peak, MiB", "mib"))),
)
