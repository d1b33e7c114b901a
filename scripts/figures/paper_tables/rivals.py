"""What Table 1 compares the network with and lte_eval does not have: networks of other papers,
trained here, and gathered light."""
from .evaluation import evaluated, generated


def training_rooms(run):
    """Homes, boxes and wild rooms with views and direct light on scene points."""
    return generated(run, "rivals", "mixed", run.size(900, 40), 990057, "mixed.homes=0.6",
                     "mixed.boxes=0.2", "mixed.wild=0.2", "evaluation_splits=[train]",
                     "path_tracing_64=false", "scene_points=4096", "query_points=2048", "rays=64",
                     "light_paths=16", "views.count=2", "views.width=48", "views.height=36",
                     "views.rays=256")


def deep_shading(run, label, data, test, split):
    return run.tool(label, "experiment_paper", "deep-shading", "--data", data, "--split", split,
                    "--test", test, "--seconds", run.size(1800, 45), "--threads", 1)


def rivals(run, test):
    """@param test  data set of homes with views and .glb files"""
    demo = evaluated(run, "demo", test, checkpoint="lte-demo")
    by_heart = deep_shading(run, "by-heart", test, test, "test")
    gathered = run.tool("gathered", "experiment_paper", "gathered", "--data", test, "--threads", 1)
    rooms = training_rooms(run)
    points = run.tool("hermosilla", "experiment_paper", "hermosilla", "--config",
                      "configs/train/shipped.yaml", "--data", rooms, "--test", test, "--set",
                      "data.queries_per_scene=512", "--set", "train.scenes_per_step=1", "--seconds",
                      run.size(1800, 90), "--tuned-seconds", run.size(5, 1.5), "--threads", 1)
    shading = deep_shading(run, "deep-shading", rooms, test, "train")
    found = (("Deep Shading, by heart", by_heart, views_of(by_heart)),
             ("Deep Shading", shading, views_of(shading)),
             ("Hermosilla, improved", points, rooms_of(points)),
             ("the same, tuned to each home", points["tuned"],
              f"and {points['tuned_seconds']:g} s each"),
             ("gathered, 16 rays", gathered, None),
             ("gathered, 16 rays, denoised", gathered["denoised"], None))
    rows = [{"scenes": "homes", "method": name, "count": each["scenes"], "training": training}
            | {key: each[key] for key in ("mse", "interval", "ssim", "flip", "worth")}
            for name, each, training in found]
    return rows + [row | {"scenes": "homes", "method": "paper's network (lte-demo)",
                          "training": "1,100 boxes, 46 min"}
                   for row in demo if row["method"] == "network, decoded"]


def views_of(found):
    return f"{found['views']} views, {found['seconds']:g} s"


def rooms_of(found):
    return f"{found['training_scenes']} rooms, {found['seconds']:g} s"
