"""Run time at equal error: Mitsuba's llvm variant and `lte_datagen probe` on the same points
(validate_against_mitsuba.py
--time).

A figure is seconds × variance: what an estimate of given error costs. Variance is that of the
estimates of several runs with seeds of their own, averaged over points and channels; Mitsuba's from
its first timed run on, after one that compiles its kernels, its scene and points in place and its
samples summed where they are made; ours of whole processes, with starting, reading the scene and
both CSV files.
"""
import csv
import pathlib
import subprocess
import tempfile
import time

import numpy as np


class Runs:
    """Estimates [points, 3] of runs with different seeds, and their seconds."""
    def __init__(self):
        self.values, self.seconds = [], []

    def add(self, run):
        start = time.perf_counter()
        value = run()
        self.seconds.append(time.perf_counter() - start)
        self.values.append(value)

    def mean(self):
        return np.mean(self.values, 0)

    def standard_error(self):
        """Of one run, relative to the mean over points: root mean square over points and
        channels."""
        return np.sqrt(np.var(self.values, 0, ddof=1).mean()) / self.mean().mean()

    def median_seconds(self):
        return float(np.median(self.seconds))

    def cost(self):
        return self.median_seconds() * self.standard_error() ** 2


class MitsubaIrradiance:
    """Total irradiance by blocks of samples that are summed on the device. Light met at the first
    hit and light sampled at the point are weighted by the balance heuristic, as ours are; the rest
    is the `path` integrator's. It meets the first hit a second time, so one ray in ten is traced in
    vain."""
    def __init__(self, mi, scene, positions, normals, depth, per_pass):
        self.mi, self.scene, self.count, self.per_pass = mi, scene, len(positions), per_pass
        self.lanes = self.count * per_pass
        self.integrator = mi.load_dict({"type": "path", "max_depth": depth, "rr_depth": 100000})
        self.lane_points = [
            mi.Float(np.repeat(column, per_pass).astype(np.float32)) for column in positions.T
        ]
        self.lane_normals = [
            mi.Float(np.repeat(column, per_pass).astype(np.float32)) for column in normals.T
        ]

    def sample(self, sampler):
        import drjit as dr
        mi = self.mi
        si = dr.zeros(mi.SurfaceInteraction3f, self.lanes)
        si.p, si.n = mi.Point3f(*self.lane_points), mi.Normal3f(*self.lane_normals)
        si.sh_frame = mi.Frame3f(si.n)
        ds, weight = self.scene.sample_emitter_direction(si, sampler.next_2d(), True)
        cosine = dr.dot(ds.d, si.n)
        share = dr.select(ds.delta, 1, ds.pdf / (ds.pdf + cosine * dr.inv_pi))
        near = dr.select((ds.pdf > 0) & (cosine > 0), weight * (cosine * share), 0)
        ray = si.spawn_ray(
            si.sh_frame.to_world(mi.warp.square_to_cosine_hemisphere(sampler.next_2d())))
        first = self.scene.ray_intersect(ray)
        emitted = first.emitter(self.scene).eval(first)
        met = mi.DirectionSample3f(self.scene, first, si)
        light_pdf = self.scene.pdf_emitter_direction(si, met, dr.neq(first.emitter(self.scene),
                                                                     None))
        pdf = dr.dot(ray.d, si.n) * dr.inv_pi
        radiance, _, _ = self.integrator.sample(self.scene, sampler, mi.RayDifferential3f(ray))
        total = near + dr.pi * (radiance - emitted * (light_pdf / (pdf + light_pdf)))
        return [dr.block_sum(channel, self.per_pass) for channel in (total.x, total.y, total.z)]

    def run(self, samples, seed):
        import drjit as dr
        passes = max(1, samples // self.per_pass)
        sums = None
        for i in range(passes):
            sampler = self.mi.load_dict({"type": "independent"})
            sampler.seed(seed * 65536 + i, self.lanes)
            total = self.sample(sampler)
            dr.eval(total)
            sums = total if sums is None else [a + b for a, b in zip(sums, total)]
        dr.eval(sums)
        dr.sync_thread()
        return np.stack([np.array(channel) for channel in sums], -1) / (passes * self.per_pass)


def probe_run(datagen, scene_path, points_path, result_path, rays, depth, seed, threads):
    subprocess.run([
        datagen, "probe",
        str(scene_path), "--points",
        str(points_path), "--out",
        str(result_path), "--rays",
        str(rays), "--max-depth",
        str(depth), "--seed",
        str(seed), "--threads",
        str(threads), "--quiet"
    ], check=True)
    with open(result_path, newline="") as file:
        return np.array([[float(row[f"total_{c}"]) for c in "rgb"] for row in csv.DictReader(file)])


def print_header():
    print(
        "| scene | | paths a point | seconds | standard error, % | seconds to 1 % | time of "
        "Mitsuba by ours, equal error |"
    )
    print("|---|---|---:|---:|---:|---:|---:|")


def print_row(name, who, paths, runs, ratio):
    print(
        f"| {name} | {who} | {paths} | {runs.median_seconds():.2f} | "
        f"{100 * runs.standard_error():.2f} | "
        f"{runs.cost() / 1e-4:.2f} | {ratio} |", flush=True)


def compare_times(mi, scene, scene_path, positions, normals, args):
    """Two lines of the table."""
    import drjit as dr
    dr.set_thread_count(args.threads)
    per_pass = min(args.samples, max(1, (1 << 20) // len(positions)))
    mitsuba = MitsubaIrradiance(mi, scene, positions, normals, args.depth, per_pass)
    samples = args.samples // per_pass * per_pass
    theirs, ours = Runs(), Runs()
    mitsuba.run(samples, args.seed)  # compiles
    with tempfile.TemporaryDirectory() as folder:
        given, result = pathlib.Path(folder) / "in.csv", pathlib.Path(folder) / "out.csv"
        np.savetxt(given, np.hstack([positions, normals]), "%.9g", ",", header="px,py,pz,nx,ny,nz",
                   comments="")
        for seed in range(args.seed + 1,
                          args.seed + 1 + args.repeats):  # in turns: a busy machine hits both
            theirs.add(lambda: mitsuba.run(samples, seed))
            ours.add(lambda: probe_run(args.datagen, scene_path, given, result, args.rays, args.
                                       depth, seed, args.threads))
    print_row(scene_path.stem, "Mitsuba", samples, theirs, f"{theirs.cost() / ours.cost():.2f}")
    print_row(scene_path.stem, "lte", args.rays, ours, "")
