#!/usr/bin/env python3
"""Compares irradiance of `lte_datagen probe` with Mitsuba 3, an independent renderer, on the same
scene and points.

Needs Mitsuba and numpy in a virtual environment of their own, and LLVM's shared library for
Mitsuba's compiler. Mitsuba 3.5.2 runs with LLVM 15, which Debian 12 has (libllvm15); Mitsuba 3.9
aborts with it and wants a newer one. Where LLVM is not found, set DRJIT_LIBLLVM_PATH to its file.

    python3 -m venv mi && mi/bin/pip install mitsuba==3.5.2 'numpy<2'
    PYTHONPATH=build/python mi/bin/python scripts/validation/validate_against_mitsuba.py \\
        --datagen build/bin/lte_datagen assets/scenes/cornell_box.glb

Draws points evenly over the surfaces, on the front side, and estimates on both sides with D hits
after leaving the point. Mitsuba has the scene from lte.to_mitsuba() (-DLTE_PYTHON=ON), and its
share is: direct light by its emitter sampling and hits at the point, balanced, the rest by its
`path` integrator along cosine-distributed rays, without Russian roulette. Metals are described in
mitsuba_metal.py.

The same scene in another format, for our side alone, is named behind a comma: room.glb,room.pbrt.
--environment lights scenes from all around: constant R,G,B or an equirectangular .pfm.

Prints a line a scene: relative bias of the irradiance summed over points, with its standard error;
the bias in standard errors; the bias of direct light alone, whose error the tool does not state;
and of the residuals (difference over standard error of each point and channel) the mean, the
variance and the share below two. --runs takes several independent runs of our side, so that its
errors are known well enough for residuals to be those of a unit normal (expect 0, 1 and 95.4 %).
Exits with 1 if a bias of the total exceeds --max-bias.

--time prints what both take for the same error instead (mitsuba_timing.py); --rays 4096 --samples
4096 do.
"""
import argparse
import csv
import os
import pathlib
import subprocess
import sys
import tempfile
import warnings

import lte
import numpy as np
from lte.bridges import to_mitsuba

from mitsuba_metal import register_conductor, surface_bsdf
import mitsuba_timing

class MitsubaScene:
    """The scene for Mitsuba, as lte.to_mitsuba() has it, and points on its surfaces."""
    def __init__(self, mi, path, environment="", plain_metal=False):
        self.ours = lte.load(path, environment=environment)
        low, high = self.ours.bounds
        middle = np.round((low + high) / 2).astype(float)
        # Mitsuba calculates in floats, and has no frame of its own for scenes far from the origin.
        self.shift = middle if np.abs(middle).max() > 16 * (high - low).max() else np.zeros(3)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error", UserWarning)
                parts = to_mitsuba.export(
                    self.ours, lambda pbr, color, name: surface_bsdf(pbr, color, plain_metal),
                    self.shift)
        except UserWarning as lacking:
            raise SystemExit(f"{path}: has no exact twin in Mitsuba: {lacking}") from None
        if any(isinstance(part, dict) and part["type"] == "spot" for part in parts.values()):
            raise SystemExit(f"{path}: a spot light has no exact twin in Mitsuba")
        self.scene = mi.load_dict(parts)

    def draw_points(self, count, seed):
        """Evenly over the area, less `self.shift`; normals are the fronts'."""
        positions, normals = (rows.astype(float) for rows in self.ours.sample(count, seed=seed))
        return positions - self.shift, normals


class Moments:
    """Running mean and variance of the mean over samples, by point and channel."""
    def __init__(self):
        self.count, self.sum, self.squares = 0, 0.0, 0.0

    def add(self, values):  # [points, samples, 3]
        values = values.astype(float)
        self.count += values.shape[1]
        self.sum = self.sum + values.sum(1)
        self.squares = self.squares + (values ** 2).sum(1)

    def mean(self):
        return self.sum / self.count

    def variance(self):
        return np.maximum(self.squares / self.count - self.mean() ** 2, 0) / (self.count - 1)


def mitsuba_irradiance(mi, scene, positions, normals, depth, samples, seed):
    """Moments of (direct, total) irradiance. Total is direct by emitter sampling and hits, plus
    hits 2 to depth."""
    import drjit as dr
    integrator = mi.load_dict({"type": "path", "max_depth": depth, "rr_depth": 100000})
    per_pass = max(1, min(samples, (1 << 21) // len(positions)))
    direct, total = Moments(), Moments()

    def lanes_of(values, repeats):  # by component: what all versions of Dr.Jit take
        return [mi.Float(np.repeat(column, repeats).astype(np.float32)) for column in values.T]

    for i in range((samples + per_pass - 1) // per_pass):
        lanes = len(positions) * per_pass
        sampler = mi.load_dict({"type": "independent"})
        sampler.seed(seed + i, lanes)
        si = dr.zeros(mi.SurfaceInteraction3f, lanes)
        si.p = mi.Point3f(*lanes_of(positions, per_pass))
        si.n = mi.Normal3f(*lanes_of(normals, per_pass))
        si.sh_frame = mi.Frame3f(si.n)
        ds, weight = scene.sample_emitter_direction(si, sampler.next_2d(), True)
        cosine = dr.dot(ds.d, si.n)
        # Points beside a lamp: light samples alone have no finite variance there, hence the balance
        # heuristic.
        share = dr.select(ds.delta, 1, ds.pdf / (ds.pdf + cosine * dr.inv_pi))
        near = dr.select((ds.pdf > 0) & (cosine > 0), weight * (cosine * share), 0)
        ray = si.spawn_ray(
            si.sh_frame.to_world(mi.warp.square_to_cosine_hemisphere(sampler.next_2d())))
        first = scene.ray_intersect(ray)
        emitted = first.emitter(scene).eval(first)
        met = mi.DirectionSample3f(scene, first, si)
        light_pdf = scene.pdf_emitter_direction(si, met, dr.neq(first.emitter(scene), None))
        pdf = dr.dot(ray.d, si.n) * dr.inv_pi
        near += dr.pi * emitted * dr.select(pdf > 0, pdf / (pdf + light_pdf), 0)
        radiance, _, _ = integrator.sample(scene, sampler, mi.RayDifferential3f(ray))
        far = dr.pi * (radiance - emitted)
        shape = (len(positions), per_pass, 3)
        near, far = (np.stack([np.array(c)
                               for c in (v.x, v.y, v.z)], -1).reshape(shape)
                     for v in (near, far))
        direct.add(near)
        total.add(near + far)
    return direct, total


def probe(datagen, scene_path, positions, normals, args, seed):
    """Runs our tool on the points; {"direct", "total", "stderr"} as arrays."""
    with tempfile.TemporaryDirectory() as folder:
        given, result = pathlib.Path(folder) / "in.csv", pathlib.Path(folder) / "out.csv"
        with open(given, "w") as file:
            file.write("px,py,pz,nx,ny,nz\n")
            for row in np.hstack([positions, normals]):
                file.write(",".join(f"{v:.9g}" for v in row) + "\n")
        sky = ["--environment", args.environment] if args.environment else []
        subprocess.run([
            datagen, "probe",
            str(scene_path), "--points",
            str(given), "--out",
            str(result), "--rays",
            str(args.rays), "--max-depth",
            str(args.depth), "--seed",
            str(seed), "--quiet", *sky
        ], check=True)
        with open(result, newline="") as file:
            rows = list(csv.DictReader(file))
    return {
        kind: np.array([[float(row[f"{kind}_{c}"]) for c in "rgb"] for row in rows])
        for kind in ("total", "direct", "stderr")
    }


def probe_runs(datagen, scene_path, positions, normals, args):
    """The mean of independent runs, whose stated variances are averaged too."""
    runs = [
        probe(datagen, scene_path, positions, normals, args, args.seed + k)
        for k in range(args.runs)
    ]
    out = {kind: np.mean([run[kind] for run in runs], 0) for kind in ("total", "direct")}
    out["stderr"] = np.sqrt(np.mean([run["stderr"] ** 2 for run in runs], 0) / args.runs)
    return out


def relative_bias(ours, theirs):
    reference = theirs.mean()
    return (ours - reference).sum() / reference.sum()


def compare(name, ours, total, direct):
    """One line of the table; returns the relative bias. Channels are taken as fully correlated: a
    bound on the error."""
    reference = total.mean()
    bias = relative_bias(ours["total"], total)
    error = np.sqrt(ours["stderr"] ** 2 + total.variance())
    bias_error = np.sqrt((error.sum(1) ** 2).sum()) / reference.sum()
    lit = error > 0
    residual = (ours["total"] - reference)[lit] / error[lit]
    print(
        f"| {name} | {len(error)} | {100 * bias:+.3f} ± {100 * bias_error:.3f} | "
        f"{bias / bias_error:+.1f} | "
        f"{100 * relative_bias(ours['direct'], direct):+.3f} | {residual.mean():+.3f} | "
        f"{residual.var():.3f} | "
        f"{100 * (np.abs(residual) < 2).mean():.1f} |", flush=True)
    return bias


def time_scenes(mi, args):
    """Prints the table of mitsuba_timing.py."""
    mitsuba_timing.print_header()
    for path in map(pathlib.Path, args.scenes):
        scene = MitsubaScene(mi, path)
        positions, normals = scene.draw_points(args.points, args.seed)
        mitsuba_timing.compare_times(mi, scene.scene, path, positions, normals, args)
    return 0


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", metavar="SCENE.glb[,OURS]")
    parser.add_argument("--environment", default="",
                        help="constant R,G,B or an equirectangular picture, for both sides")
    parser.add_argument("--runs", type=int, default=1, help="independent runs of our side")
    parser.add_argument("--datagen", required=True, help="path of lte_datagen")
    parser.add_argument("--points", type=int, default=256)
    parser.add_argument("--rays", type=int, default=8192, help="our paths a point")
    parser.add_argument("--samples", type=int, default=16384, help="Mitsuba's paths a point")
    parser.add_argument("--depth", type=int, default=5)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--max-bias", type=float, default=0.005,
                        help="exit with 1 above this relative bias")
    parser.add_argument("--time", action="store_true",
                        help="compare run time at equal error instead")
    parser.add_argument("--threads", type=int, default=os.cpu_count(), help="of both, with --time")
    parser.add_argument("--repeats", type=int, default=8,
                        help="runs of both with seeds of their own, with --time")
    parser.add_argument(
        "--plain-metal", action="store_true", help=
        "metal as Mitsuba's own roughconductor: another masking and no Fresnel, so a bias is "
        "expected"
    )
    args = parser.parse_args()
    try:
        import mitsuba as mi
        mi.set_variant("llvm_ad_rgb")
        register_conductor(mi)
    except ImportError as error:
        raise SystemExit(f"Mitsuba is not usable ({error}); see --help for how to install it")
    mi.set_log_level(mi.LogLevel.Error)
    if args.time:
        return time_scenes(mi, args)
    print(
        "| scene | points | bias of total, % | z | bias of direct, % | residuals: mean | variance "
        "| below 2, % |"
    )
    print("|---|---|---|---|---|---|---|---|")
    failed = False
    for name in args.scenes:
        path, _, ours_path = name.partition(",")
        path, ours_path = pathlib.Path(path), ours_path or path
        scene = MitsubaScene(mi, path, args.environment, args.plain_metal)
        positions, normals = scene.draw_points(args.points, args.seed)
        ours = probe_runs(args.datagen, ours_path, positions + scene.shift, normals, args)
        direct, total = mitsuba_irradiance(mi, scene.scene, positions, normals, args.depth,
                                           args.samples, args.seed)
        bias = compare(pathlib.Path(ours_path).name, ours, total, direct)
        failed |= abs(bias) > args.max_bias
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
