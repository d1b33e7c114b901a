"""Rows of docs/paper.md that lte_eval measures: data sets of new seeds, and errors of every method
on their pictures."""
import json
import shutil
import statistics

from .words import digits

# Rooms over 16 m, the scale of the models, which data sets of that scale do not hold.
TOO_LARGE = {f"infinigen_{name}" for name in ("bedroom", "dining_room", "living_room",
                                              "living_room_day")}
METHODS = (("network, decoded", "neural"), ("start without network", "light_cache"),
           ("64 paths", "path_tracing_64"), ("64 paths, denoised", "path_tracing_64_denoised"),
           ("16 paths, denoised", "path_tracing_16_denoised"))
CLEAN = ("--denoise-references",)  # of 512 paths a pixel, whose noise would rule SSIM


def evaluated(run, label, data, checkpoint="lte", flags=()):
    """Errors of all methods on a data set, in pictures, a row each."""
    result = run.tool(f"{label}-eval", "lte_eval", "--checkpoint",
                      f"assets/models/{checkpoint}.safetensors", "--data", data, "--split", "test",
                      *flags)
    rows = []
    noise = statistics.mean(scene["views_noise_mse"] for scene in result["per_scene"])
    for name, key in METHODS:
        views = (result["metrics"].get(key) or {}).get("views") or {}
        if views.get("mse") is None:
            continue
        bounds = result["confidence"]["metrics"].get(key, {}).get("views", {}).get("mse")
        samples = result["equal_samples"].get(key, {}).get("views", {}).get("all")
        rows.append({"scenes": label, "count": result["scenes"], "method": name,
                     "mse": views["mse"], "interval": bounds, "ssim": views.get("ssim"),
                     "flip": views.get("flip"), "worth": samples, "noise": noise})
    return rows


def without_noise(row, noise):
    """A row whose MSE is without that of the references."""
    return row | {"mse": row["mse"] - noise, "interval": [end - noise for end in row["interval"]]}


def triangles_of(run, data):
    lines = (run.root / data / "manifest" / "shard_0_of_1.jsonl").read_text().splitlines()
    scenes = {s["name"]: s["triangles"] for s in map(json.loads, lines)
              if s.get("status") == "baked"}
    return sorted(scenes.values())


def generated(run, label, config, scenes, seed, *settings, flags=()):
    data = run.folder(label)
    words = [word for setting in settings for word in ("--set", setting)]
    run.tool(label, "lte_datagen", "generate", "--config", f"configs/data/{config}.yaml", "--out",
             data, "--scenes", scenes, "--seed", seed, "--resume", *flags, *words, shared=True)
    return data


def views(run, rays):
    width, height = run.size((256, 192), (48, 36))
    return f"views.width={width}", f"views.height={height}", f"views.rays={rays}"


def homes(run):
    """Homes of a seed that nothing was tuned on, with their meshes."""
    return generated(run, "homes", "homes_test", run.size(100, 12), 880057,
                     *views(run, run.size(512, 1024)), flags=["--glb"])


def outside(run):
    """Rooms that no generator of ours made, with the pixels and paths of the homes."""
    scenes = [file for file in sorted((run.root / "assets/scenes/outside").glob("*.glb"))
              if file.stem not in TOO_LARGE]
    folder = run.folder("outside-scenes")
    (run.root / folder).mkdir(exist_ok=True)
    for file in scenes:
        shutil.copyfile(file, run.root / folder / file.name)
    return generated(run, "outside", "files", run.size(len(scenes), 6), 880061, "val_share=0",
                     "test_share=1", "query_points=1024", "rays=512",
                     *views(run, run.size(512, 1024)), f"files.folder={folder}", flags=["--glb"])


def statistics_of_scenes(run):
    data = generated(run, "large-homes", "homes", run.size(20, 4), 880058, "val_share=0",
                     "test_share=1", "scene_points=8192", "query_points=512", "rays=128",
                     "views.width=48", "views.height=36", "views.rays=512")
    triangles = triangles_of(run, data)
    return [row | {"least": triangles[0], "median": statistics.median(triangles),
                   "most": triangles[-1]} for row in evaluated(run, "large homes", data)]


def failures(run):
    rows = []
    for label, share in (("rooms", 0), ("pairs of rooms", 1)):
        data = generated(run, f"boxes-{share}", "boxes_test", run.size(40, 8), 880059,
                         f"boxes.two_room_share={share}")
        rows += evaluated(run, label, data)
    return rows


def materials(run):
    data = generated(run, "wild", "wild_test", run.size(24, 6), 880060)
    return evaluated(run, "wild rooms", data)


def eval_line(rows):
    parts = []
    for label in dict.fromkeys(row["scenes"] for row in rows):
        by = {row["method"]: row for row in rows if row["scenes"] == label}
        ours, paths = by["network, decoded"], by["64 paths"]
        parts.append(f"{ours['count']} {label}: MSE {digits(ours['mse'])}, SSIM "
                     f"{digits(ours['ssim'])}; 64 paths {digits(paths['mse'])}, "
                     f"{digits(paths['ssim'])}")
    return "; ".join(parts)


def size_line(rows):
    first = rows[0]
    return (f"{first['least']:,} to {first['most']:,} triangles, median {first['median']:,.0f}; "
            + eval_line(rows))


EVAL_COLUMNS = (("method", "method"), ("learnt from", "training"), ("MSE", "mse"),
                ("95 %", "interval"), ("SSIM", "ssim"), ("FLIP", "flip"),
                ("paths of equal error", "worth"))
