"""The rows of docs/paper.md: the commands behind each, what their JSON gives, and a line about it.
scripts/figures/paper.py runs the commands and writes the page."""
import dataclasses
import typing

from . import cornell, edits, growth, plans, trainings
from .evaluation import (CLEAN, EVAL_COLUMNS, eval_line, evaluated, failures, homes, materials,
                        outside, size_line, statistics_of_scenes, without_noise)
from .rivals import outside_columns, rivals
from .words import digits

ROOM = edits.ROOM


@dataclasses.dataclass(frozen=True)
class Row:
    name: str
    items: str  # of the paper
    theirs: str
    cost: str  # processor time of the whole row, and of --quick
    make: typing.Callable  # Run -> rows, dicts of plain values
    line: typing.Callable  # rows -> what they say, in a few words
    columns: tuple[tuple[str, str], ...]  # heading, key of a row


def table1(run):
    data, rooms = homes(run), outside(run)
    found = evaluated(run, "homes", data, flags=CLEAN)
    elsewhere = {row["method"]: row for row in evaluated(run, "outside", rooms, flags=CLEAN)}
    found = [row | outside_columns(elsewhere[row["method"]]) for row in found]
    found[0]["training"] = "6,000 rooms, 13 h"  # by the card of lte
    return [without_noise(row, found[0]["noise"]) for row in found + rivals(run, data, rooms)]


def sampling(run):
    """Of homes, what points drawn in one way or another are worth to lte."""
    return run.tool("sampling", "experiment_paper", "sampling", "--data", homes(run),
                    "--checkpoint", "assets/models/lte.safetensors", "--candidates",
                    run.size(65_536, 32_768), "--threads", 1)


def sampling_line(rows):
    return "error over that of even points: " + "; ".join(
        f"{row['draw']} {digits(row['ratio'])} ({cell_range(row['ratio_interval'])})"
        for row in rows[1:])


def cell_range(values):
    return "–".join(digits(value, 2) for value in values)


# Memory, by a process a row.

def measured(run, network, primitives, channels=128, attention="fused"):
    return run.tool(f"{network}-{attention}-{channels}-{primitives}", "experiment_paper", "memory",
                    "--network", network, "--primitives", primitives, "--channels", channels,
                    "--attention", attention, "--threads", 1)


def memory(run):
    rows = []
    for primitives in run.size((512, 1024, 2048, 4096, 8192), (512, 1024, 2048)):
        rows.append(measured(run, "renderformer", primitives))
        rows.append(measured(run, "whole", primitives))
        rows += [measured(run, "vanilla", primitives, attention=how) for how in ("fused", "stored")]
    return rows


def slope(rows, **where):
    """MB a primitive between the ends of a curve."""
    ends = sorted((row["primitives"], row["peak_rss_mb"]) for row in rows
                  if all(row[k] == v for k, v in where.items()))
    return (ends[-1][1] - ends[0][1]) / (ends[-1][0] - ends[0][0])


def memory_line(rows):
    most = max(row["primitives"] for row in rows)
    kinds = (("RenderFormer's shape", "renderformer", "fused"), ("ours", "whole", "fused"),
             ("vanilla", "vanilla", "fused"), ("vanilla, stored", "vanilla", "stored"))
    return f"MB a primitive up to {most:,}: " + "; ".join(
        f"{name} {digits(slope(rows, network=key, attention=how), 2)}" for name, key, how in kinds)


def width(run):
    points = run.size(20000, 4096)
    return [measured(run, "whole", points, channels)
            for channels in run.size((64, 128, 256), (64, 128))]


def width_line(rows):
    return "; ".join(f"D {row['channels']}: {row['parameters'] / 1e6:.1f} M, "
                     f"{row['peak_rss_mb'] / 1e3:.2g} GB" for row in rows)


# One scene.

def room_sample(run):
    sample = run.folder("room") + ".safetensors"
    run.tool("room", "lte_datagen", "bake", ROOM, "--out", sample, "--scene-points", 8192,
             "--queries", run.size(2_000_000, 40_000), "--rays", run.size(128, 64), "--views", 0,
             shared=True)
    return sample


def by_heart(run):
    sample = room_sample(run)
    trials = [("hash grid, 2^15", "grid", 15, 0), ("hash grid, 2^19", "grid", 19, 0),
              ("latents, mean", "latents-mean", 15, 0),
              ("latents, query decoder", "latents-decoder", 15, 0),
              ("the same, an eighth of the queries", "latents-decoder", 15,
               run.size(262_144, 4500))]
    rows = []
    for name, method, entries, queries in trials:
        found = run.tool(f"{method}-{entries}-{queries}", "experiment_paper", "by-heart", sample,
                         "--method", method, "--log2-entries", entries, "--queries", queries,
                         "--seconds", run.size(300, 20), "--threads", 1)
        rows.append({"name": name, "queries": found["learnt_queries"],
                     "parameters": found["parameters"], "first": found["first_relmse"],
                     "middle": found["looks"][3]["held_out_relmse"],
                     "held_out": found["looks"][-1]["held_out_relmse"],
                     "learnt": found["learnt_relmse"],
                     "seconds": found["looks"][-1]["seconds"]})
    return rows


def by_heart_line(rows):
    return "held-out error, relative: " + "; ".join(
        f"{row['name']} {digits(row['held_out'], 2)}" for row in rows)


def edited_rooms(run):
    return edits.measure(run, room_sample(run))


# Pictures.

def teaser(run):
    rows = []
    for name, words in (("network", ["--integrator", "network", "--checkpoint",
                                     "assets/models/lte.safetensors", "--quality",
                                     run.size("preview", "draft")]),
                        ("paths", ["--integrator", "path", "--spp", run.size(64, 4)])):
        picture = run.folder(f"{name}.png")
        (run.root / picture).unlink(missing_ok=True)
        found = run.tool(name, "lte_render", ROOM, "--size", "2688x1152", "--out", picture, *words)
        rows.append({"method": name, "seconds": run.seconds(name), "cpu": run.cpu_seconds(name),
                     "peak_rss_mb": found["peak_rss_mb"]})
    return rows


def teaser_line(rows):
    return "2688x1152: " + "; ".join(f"{row['method']} {digits(row['cpu'], 2)} CPU s, "
                                     f"{row['peak_rss_mb']:.0f} MB" for row in rows)


def flicker(run):
    found = run.tool("flicker", "experiment_consistency", ROOM, "--size",
                     run.size("192x144", "64x48"), "--frames", run.size(60, 6), "--spp", 16)
    return [found]


def flicker_line(rows):
    return (f"{rows[0]['answers']:,} answers at points seen twice: largest change "
            f"{digits(rows[0]['largest_change'])}")


ROWS = (
    Row("table1", "Table 1", "MSE .048, SSIM .912; 64 paths .051, .425; "
        "Deep Shading .071, .882; Hermosilla .171, .775",
        "5 h; 7 min", table1, eval_line,
        (*EVAL_COLUMNS, ("outside: SSIM", "outside_ssim"), ("paths", "outside_worth"))),
    Row("plans", "Figure 7: SSIM, FLIP, LPIPS of plans", "six plans", "30 min; 2 min",
        plans.plans, plans.line,
        (("home", "home"), ("method", "method"), ("SSIM", "ssim"), ("FLIP", "flip"),
         ("LPIPS", "lpips"))),
    Row("sampling", "Sampling of scene points", "no effect", "15 min; 3 min", sampling,
        sampling_line,
        (("draw", "draw"), ("points", "points"), ("MSE", "mse"), ("over even", "ratio"),
         ("95 %", "ratio_interval"))),
    Row("cornell", "Cornell box by RenderFormer", "picture", "20 min; 1 min",
        cornell.cornell, cornell.line,
        (("triangles", "triangles"), ("relative MSE", "relmse"), ("FLIP", "flip"),
         ("CPU s", "cpu"), ("peak MB", "peak_rss_mb"), ("its shape: CPU s", "rf_cpu"),
         ("MB", "rf_mb"))),
    Row("growth", "Growth", "PSNR by points alone", "40 min; 5 min", trainings.growth_rows,
        growth.line,
        (("of", "kind"), ("value", "value"), ("seed", "seed"), ("MSE", "mse"))),
    Row("statistics", "Scene statistics", "0.8 to 6 M triangles, 29 to 51 textures of 1024²",
        "8 min; 1 min", statistics_of_scenes, size_line, EVAL_COLUMNS),
    Row("failures", "Failures: lamp next door", "a picture", "8 min; 1 min", failures, eval_line,
        EVAL_COLUMNS),
    Row("materials", "Failures: unusual textures", "a picture", "4 min; 1 min", materials,
        eval_line, EVAL_COLUMNS),
    Row("roadmap", "Figures 11, 12: roadmap, MSE", "vanilla .068; + encoder .084; + decoder .048",
        "1 h; 6 min", trainings.roadmap, trainings.roadmap_line,
        (("network", "network"), ("seed", "seed"), ("parameters", "parameters"), ("MSE", "mse"),
         ("MSE / mean square", "share"), ("ms a step", "step_ms"),
         ("peak MB", "peak_rss_mb"))),
    Row("hyperparameters", "Neighbours, points, D, layers, patches, queries",
        "PSNR: kappa 8 26.96, 32 34.57; 5 k points 28.51, 20 k 34.57", "2 h; 6 min",
        trainings.hyperparameters, trainings.variants_line,
        (("variant", "variant"), ("seed", "seed"), ("MSE / mean square", "share"),
         ("over as trained", "ratio"), ("ms a step", "step_ms"), ("peak MB", "peak_rss_mb"))),
    Row("memory", "Figure 2: memory", "1.7 and .12 MB a primitive", "10 min; 2 min", memory,
        memory_line,
        (("network", "network"), ("attention", "attention"), ("primitives", "primitives"),
         ("parameters", "parameters"), ("peak MB", "peak_rss_mb"), ("CPU s", "cpu_seconds"))),
    Row("width", "D: parameters, memory", "10.5, 42, 167.7 M; 10.7, 21.3, 43.1 GB",
        "3 min; 10 s", width, width_line,
        (("D", "channels"), ("parameters", "parameters"), ("scene points", "primitives"),
         ("peak MB", "peak_rss_mb"), ("CPU s", "cpu_seconds"))),
    Row("by-heart", "One scene: hash grid, latents, queries",
        "pictures: the grid converges sooner", "45 min; 2 min", by_heart, by_heart_line,
        (("method", "name"), ("queries", "queries"), ("parameters", "parameters"),
         ("at first", "first"), ("half time", "middle"), ("held out", "held_out"),
         ("learnt", "learnt"))),
    Row("edits", "Figures: light, object, albedo", "pictures", "25 min; 1 min", edited_rooms,
        edits.line,
        (("change", "change"), ("method", "method"), ("points", "points"),
         ("change over light", "size"),
         ("error of the change", "error_of_change"), ("error after", "error_after"))),
    Row("teaser", "Figure 1", "a picture of 2688x1152", "20 min; 2 min", teaser, teaser_line,
        (("method", "method"), ("seconds", "seconds"), ("CPU s", "cpu"),
         ("peak MB", "peak_rss_mb"))),
    Row("flicker", "View consistency", "a video", "5 min; 10 s", flicker, flicker_line,
        (("answers", "answers"), ("largest change", "largest_change"))),
)
