"""What Table 1 compares the network with and lte_eval does not have: networks of other papers,
trained here, and gathered light."""
from .evaluation import CLEAN, evaluated, generated, views

ROOMS = ("mixed.homes=0.6", "mixed.boxes=0.2", "mixed.wild=0.2", "evaluation_splits=[train]",
         "path_tracing_64=false")


def training_rooms(run):
    """Homes, boxes and wild rooms with direct light on scene points."""
    return generated(run, "rivals", "mixed", run.size(750, 40), 990057, *ROOMS,
                     "scene_points=4096", "query_points=2048", "rays=64", "light_paths=16")


def training_views(run):
    """The same rooms, a view of each. Of few paths: what is learnt from it is denoised."""
    return generated(run, "rival-views", "mixed", run.size(750, 40), 990057, *ROOMS,
                     "scene_points=256", "query_points=256", "rays=16", "views.count=1",
                     *views(run, run.size(16, 256)))


def deep_shading(run, label, data, split, *tests):
    return run.tool(label, "experiment_paper", "deep-shading", "--data", data, "--split", split,
                    *tests, "--seconds", run.size(1800, 45), "--threads", 1)


def hermosilla(run, data, *tests):
    return run.tool("hermosilla", "experiment_paper", "hermosilla", "--config",
                    "experiments/paper/rivals.yaml", "--data", data, *tests, "--set",
                    "data.queries_per_scene=512", "--set", "train.scenes_per_step=1", "--seconds",
                    run.size(1800, 90), "--tuned-seconds", run.size(5, 1.5), "--threads", 1)


def gathered_light(run, label, data):
    return run.tool(label, "experiment_paper", "gathered", "--data", data, "--threads", 1)


def paper_row(run, label, data):
    rows = evaluated(run, label, data, checkpoint="lte-paper", flags=CLEAN)
    return next(row for row in rows if row["method"] == "network, decoded")


def outside_columns(found):
    return {"outside_ssim": found["ssim"], "outside_worth": found["worth"]} if found else {}


def rivals(run, homes, outside):
    """@param homes, outside  data sets of scenes with views and .glb files"""
    by_heart = deep_shading(run, "by-heart", homes, "test", "--test", homes)
    gathered = gathered_light(run, "gathered", homes)
    gathered_outside = gathered_light(run, "gathered-outside", outside)
    rooms = training_rooms(run)
    tests = ["--test", homes, "--also", outside]
    points = hermosilla(run, rooms, *tests)
    shading = deep_shading(run, "deep-shading", training_views(run), "train", *tests)
    [points_outside], [shading_outside] = points["also"], shading["also"]
    found = (("Deep Shading, by heart", by_heart, None, views_of(by_heart)),
             ("Deep Shading", shading, shading_outside, views_of(shading)),
             ("Hermosilla, improved", points, points_outside, rooms_of(points)),
             ("the same, tuned to each scene", points["tuned"], points_outside["tuned"],
              f"and {points['tuned_seconds']:g} s each"),
             ("gathered, 16 rays", gathered, gathered_outside, None),
             ("gathered, 16 rays, denoised", gathered["denoised"], gathered_outside["denoised"],
              None))
    rows = [{"scenes": "homes", "method": name, "count": each["scenes"], "training": training}
            | {key: each[key] for key in ("mse", "interval", "ssim", "flip", "worth")}
            | outside_columns(elsewhere)
            for name, each, elsewhere, training in found]
    paper, elsewhere = paper_row(run, "paper", homes), paper_row(run, "paper-outside", outside)
    return rows + [paper | outside_columns(elsewhere)
                   | {"scenes": "homes", "method": "paper's network (lte-paper)",
                      "training": "6,000 rooms, 1 h"}]


def views_of(found):
    return f"{found['views']} views, {found['seconds']:g} s"


def rooms_of(found):
    return f"{found['training_scenes']} rooms, {found['seconds']:g} s"
