"""Rows of docs/paper.md that train the network, and what it replaced, on boxes: all see emission
alone, and take as many steps. Encoder and decoder are those of lte-base at width 32: in 500 steps
they learn what the paper's stages have not learnt after 3,000 (docs/lab/learning.md)."""
import dataclasses

from . import growth
from .evaluation import generated
from .words import digits, mean_of, spread_of

NETWORKS = ("vanilla", "encoder", "whole")
SEEDS = (1, 2)
CONFIG = "configs/train/demo.yaml"
SETTINGS = ("model.light_input=emission", "train.optimizer=adamw", "data.queries_per_scene=256",
            "train.validation_scenes=0", "train.validation_queries=1024")
HARDLY_TRAINED = 0.5  # of the first error: a network above it has learnt next to nothing


def boxes(run, queries=4096):
    label = "boxes" if queries == 4096 else f"boxes-{queries}"
    return generated(run, label, "boxes_small", run.size(1500, 240), 4057, "rays=64",
                     f"query_points={queries}", f"scene_points={run.size(4096, 1024)}",
                     "views.count=0", "val_share=0.1", "test_share=0.1",
                     "evaluation_splits=[]", "light_paths=1", "path_tracing_64=false",
                     "boxes.texture_sizes=[64]")


def trained(run, label, network, seed, words=(), data=None):
    """One network; rows share its result. Errors are those of the test split, which nothing was
    chosen by."""
    settings = [f"data.scene_points={run.size(1024, 256)}", *SETTINGS,
                f"train.scenes_per_step={run.size(2, 4)}"]
    found = run.tool(f"{label}-{seed}", "experiment_paper", "roadmap", "--network", network,
                     "--config", CONFIG, "--data", data or boxes(run),
                     "--steps", run.size(4000, 1000), "--seed", seed, "--threads", 1,
                     *(w for s in settings for w in ("--set", s)), *words, training=True)
    return found | {"step_ms": 1e3 * found["cpu_seconds"] / found["steps"],
                    "mse": found["test"]["mse"], "share": found["test"]["share"]}


def roadmap(run):
    return [trained(run, network, network, seed) for seed in SEEDS for network in NETWORKS]


def whole(run, seed):
    return trained(run, "whole", "whole", seed)


def roadmap_line(rows):
    names = list(zip(("vanilla", "+ encoder", "+ query decoder"), NETWORKS))
    first = mean_of(rows, "first_share")  # of the scenes that validate, as the looks
    last = [row["looks"][-1]["share"] for row in rows]
    each = "; ".join(f"{name} {spread_of(rows, 'share', network=key)} "
                     f"({digits(mean_of(rows, 'step_ms', network=key), 2)} ms a step)"
                     for name, key in names)
    verdict = "; hardly trained" if min(last) > HARDLY_TRAINED * first else ""
    return (f"MSE / mean square: {each}; validation from {digits(first)} to {digits(min(last))} to "
            f"{digits(max(last))}{verdict}")


@dataclasses.dataclass(frozen=True)
class Variant:
    name: str
    keys: tuple[str, ...] = ()
    queries: int = 4096  # of a scene's, that are known
    quick: bool = False


def set_keys(keys):
    return [word for key in keys for word in ("--set", key)]


def variants(run):
    """What the paper's tables vary."""
    points, patch = run.size(1024, 256), run.size(128, 32)
    return (
        Variant("kappa 8", ("model.query_neighbours=8",), quick=True),
        Variant("kappa 32", ("model.query_neighbours=32",)),
        Variant("kappa 48", ("model.query_neighbours=48",)),
        Variant(f"{points // 4} points", (f"data.scene_points={points // 4}",), quick=True),
        Variant(f"{points // 2} points", (f"data.scene_points={points // 2}",)),
        Variant(f"{points * 2} points", (f"data.scene_points={points * 2}",)),
        Variant("D 16", ("model.channels=16", "model.head_width=16"), quick=True),
        Variant("D 64", ("model.channels=64",)),
        Variant("D 128", ("model.channels=128",)),
        Variant("2 layers", ("model.query_layers=2",)),
        Variant("6 layers", ("model.query_layers=6",)),
        Variant("the paper's stages", ("model.preset=paper", "model.encoder_depths=[2,2,2,6,2]",
                                       "model.decoder_depths=[2,2,2,2]")),
        Variant(f"patches of {patch}", (f"model.patch_size={patch}",)),
        Variant("256 query points", queries=256, quick=True))


def hyperparameters(run):
    rows = []
    for seed in SEEDS:
        usual = whole(run, seed)
        rows.append({"variant": "as trained"} | usual | {"ratio": 1.0})
        for variant in variants(run):
            if run.quick and not variant.quick:
                continue
            found = trained(run, variant.name.replace(" ", "-"), "whole", seed,
                            set_keys(variant.keys), boxes(run, variant.queries))
            rows.append({"variant": variant.name} | found
                        | {"ratio": found["share"] / usual["share"]})
    return rows


def variants_line(rows):
    names = dict.fromkeys(row["variant"] for row in rows)
    return "error over that as trained: " + "; ".join(
        f"{name} {spread_of(rows, 'ratio', variant=name)}"
        for name in names if name != "as trained")


def growth_rows(run):
    """Steps by the log of lte-paper; scenes and parameters by trainings."""
    rows = growth.steps(run.root)
    for seed in SEEDS:
        trainings = [("scenes", trained(run, f"scenes-{scenes}", "whole", seed,
                                        ["--scenes", scenes]))
                     for scenes in run.size((60, 240), (48, 96))]
        trainings.append(("scenes", whole(run, seed)))
        wide = next(v for v in variants(run) if v.name == "D 64")
        narrow = next(v for v in variants(run) if v.name == "D 16")
        for variant in run.size((narrow, wide), (narrow,)):
            trainings.append(("parameters", trained(run, variant.name.replace(" ", "-"), "whole",
                                                    seed, set_keys(variant.keys))))
        trainings.append(("parameters", whole(run, seed)))
        rows += [{"kind": kind, "value": found[kind], "seed": seed, "mse": found["mse"]}
                 for kind, found in trainings]
    return rows
