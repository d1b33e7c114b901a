"""The row of figure 7: homes seen from within, by the network as lte_render shows it and by paths,
and how far from a reference by SSIM, FLIP and LPIPS."""
import json
import sys

from .evaluation import homes
from .words import digits, mean_of

METHODS = (("network", ("--integrator", "network", "--checkpoint",
                        "assets/models/lte.safetensors")),
           ("64 paths", ("--integrator", "path", "--spp", 64, "--set", "denoise=off")),
           ("64 paths, denoised", ("--integrator", "path", "--spp", 64)))


def picture(run, label, home, words):
    path = run.folder(label + ".exr")
    run.tool(label, "lte_render", home, "--out", path, "--size", run.size("256x192", "96x72"),
             "--threads", 1, *words)
    return path


def perceptual_distances(run, label, reference, pictures):
    """LPIPS, or nothing where what it needs is not installed."""
    try:
        import perceptual_distance
        perceptual_distance.read_weights()
    except perceptual_distance.Missing as missing:
        print(f"paper.py: {missing}", file=sys.stderr)
        return [None] * len(pictures)
    path = run.out / run.row / f"{label}.json"
    run.run(label, [sys.executable, "scripts/figures/perceptual_distance.py", "--json", path,
                    reference, *pictures], path)
    return json.loads((run.root / path).read_text())


def plans(run):
    rows = []
    folder = run.root / homes(run)
    for home in sorted(folder.rglob("*.glb"))[:run.size(6, 3)]:
        reference = picture(run, f"{home.stem}-reference", home.relative_to(run.root),
                            ("--integrator", "path", "--spp", run.size(4096, 512), "--seed", 2,
                             "--set", "denoise=off"))
        pictures = [picture(run, f"{home.stem}-{name.replace(' ', '-')}",
                            home.relative_to(run.root), words) for name, words in METHODS]
        scores = run.tool(f"{home.stem}-scores", "lte_eval", "pictures", *pictures, "--reference",
                          reference)
        far = perceptual_distances(run, f"{home.stem}-lpips", reference, pictures)
        rows += [{"home": home.stem, "method": name, "ssim": score["ssim"], "flip": score["flip"],
                  "lpips": distance}
                 for (name, _), score, distance in zip(METHODS, scores, far)]
    return rows


def line(rows):
    count = len({row["home"] for row in rows})
    keys = [key for key in ("ssim", "flip", "lpips") if all(row[key] is not None for row in rows)]
    return f"{count} homes, whole pictures: " + "; ".join(
        f"{name} " + ", ".join(f"{key.upper()} {digits(mean_of(rows, key, method=name))}"
                               for key in keys) for name, _ in METHODS)
