#!/usr/bin/env python3
"""Compares the network with path tracing denoised by Intel's Open Image Denoise, on indirect
irradiance without texture.

usage: scripts/witnesses/compare_denoiser.py --data DIR [--split test] [--eval eval.json]
       scripts/witnesses/compare_denoiser.py SCENE [--size 512x512] [--checkpoint C] \\
           [--camera CAM.json] [--spp 1024] [--build build]

The first form denoises the views' stored estimates of 64 paths and scores them as lte_eval does
(docs/metrics.md); with lte_eval's JSON it prints the network's figures of the same scenes beside
them. The second renders one view by the network, by path tracing with as many paths as fit into the
same time less the denoiser's, and by path tracing as a reference. Loading the scene and writing the
picture count for neither. Needs PyPI's numpy and pyoidn; the second form OpenEXR too.
"""
import argparse
import json
import pathlib
import struct
import subprocess
import sys
import tempfile
import time

import numpy as np
import pyoidn

STAGES = {
    "neural": ("sample", "light", "encode", "primary", "decode"),
    "moved camera": ("primary", "decode")
}


def read_safetensors(path):
    raw = pathlib.Path(path).read_bytes()
    size = struct.unpack("<Q", raw[:8])[0]
    types = {"F32": "<f4", "I32": "<i4", "U8": "u1", "F16": "<f2"}
    out = {}
    for name, entry in json.loads(raw[8:8 + size]).items():
        if name != "__metadata__":
            begin, end = (8 + size + offset for offset in entry["data_offsets"])
            out[name] = np.frombuffer(raw[begin:end], types[entry["dtype"]]).reshape(entry["shape"])
    return out


def luminance(rgb):
    return rgb @ np.array([0.2126, 0.7152, 0.0722])


def scores(found, reference):
    """MSE, PSNR and relative MSE of [pixels, 3] values, as docs/metrics.md defines them."""
    square = (found - reference) ** 2
    white = np.sort(luminance(reference))[int(0.99 * (len(reference) - 1))] or 1
    mse = square.mean()
    return mse, min(
        100, 10 * np.log10(white ** 2 / mse)) if mse > 0 else 100, (square /
                                                                    (reference ** 2 + 0.01)).mean()


def denoise(color, albedo, normal):
    """The picture, and the seconds of filtering alone: the fastest of three, as the first call sets
    up the device."""
    seconds = []
    for _ in range(3):
        start = time.perf_counter()
        out = pyoidn.denoise(np.ascontiguousarray(color,
                                                  "f4"), albedo=np.ascontiguousarray(albedo, "f4"),
                             normal=np.ascontiguousarray(normal, "f4"), hdr=True)
        seconds.append(time.perf_counter() - start)
    return np.maximum(out, 0), min(seconds)


def print_rows(rows):
    print(f"{'':44}{'mse':>12}{'psnr':>10}{'relmse':>12}")
    for name, values in rows:
        print(f"{name:44}" +
              "".join(f"{value:{width}.4g}" for value, width in zip(values, (12, 10, 12))))


def of_data(arguments):
    folder = pathlib.Path(arguments.data)
    info = json.loads((folder / "dataset.json").read_text())
    names = [scene["name"] for scene in info["scenes"] if scene["split"] == arguments.split]
    noisy, clean, used, seconds = [], [], [], 0
    for name in names:
        scene = read_safetensors(folder / "scenes" / f"{name}.safetensors")
        area = scene["scene_area"].astype("f8")
        scalar = (area * scene["scene_emission"].astype("f8").mean(1)).sum() / area.sum() or 1
        views = []
        for k in range(1000):
            view = lambda part: scene[f"view{k}_{part}"]
            if f"view{k}_path_traced_64" not in scene:
                break
            mask = (view("mask") > 0) & (view("albedo").max(-1) > 0
                                        )  # lte_eval leaves black surfaces out too
            traced = view("path_traced_64") / scalar
            smooth, spent = denoise(traced, view("albedo"), view("normal"))
            seconds += spent
            reference = (view("indirect").sum(0) / scalar)[mask]
            views.append((scores(traced[mask], reference), scores(smooth[mask], reference)))
        if views:
            noisy.append(np.mean([v[0] for v in views],
                                 0)), clean.append(np.mean([v[1] for v in views],
                                                           0)), used.append(name)
    if not used:
        sys.exit(f"{folder}: no scene of split {arguments.split} has views with path_traced_64")
    rows = [("path tracing, 64 paths", np.mean(noisy, 0)),
            ("path tracing, 64 paths, denoised", np.mean(clean, 0))]
    medians = [("path tracing, 64 paths", np.median(noisy, 0)),
               ("path tracing, 64 paths, denoised", np.median(clean, 0))]
    if arguments.eval:
        of_scene = {
            s["name"]: s["metrics"]["neural"]["views"]
            for s in json.loads(pathlib.Path(arguments.eval).read_text())["per_scene"]
        }
        own = [[of_scene[name][metric] for metric in ("mse", "psnr", "relmse")] for name in used]
        rows.append(("network", np.mean(own, 0))), medians.append(("network", np.median(own, 0)))
    print(f"views of {len(used)} scenes, denoising took {seconds:.3f} s in all; mean over scenes")
    print_rows(rows)
    print("median over scenes")
    print_rows(medians)


def of_scene(arguments):
    import OpenEXR

    def render(mode, *more):
        with tempfile.TemporaryDirectory() as folder:
            out, times = pathlib.Path(folder) / "out.exr", pathlib.Path(folder) / "out.json"
            command = [
                f"{arguments.build}/bin/lte_render", arguments.scene, "--output", "irradiance",
                "--mode", mode, "--quiet", "--size", arguments.size, "--out",
                str(out), "--json",
                str(times), *more
            ]
            if arguments.camera:
                command += ["--camera", arguments.camera]
            done = subprocess.run(command, capture_output=True, text=True)
            if done.returncode != 0:
                sys.exit(done.stderr.strip())
            seconds = json.loads(times.read_text())["seconds"]
            channels = {
                name: np.array(channel.pixels)
                for name, channel in OpenEXR.File(str(out)).channels().items()
            }
        layers = {}
        for name, pixels in channels.items():
            layer = name.rpartition(".")[0] if "." in name else ""
            if pixels.ndim == 3:
                layers[name if name != "RGB" and name != "RGBA" else ""] = pixels[..., :3]
            else:
                layers.setdefault(layer, {})[name[-1]] = pixels
        stack = lambda v: v if isinstance(v, np.ndarray) else np.stack(
            [v[c] for c in ("RGB" if "R" in v else "XYZ")], -1)
        return {k: stack(v) for k, v in layers.items() if isinstance(v, np.ndarray) or len(v) >= 3
               }, seconds

    model = ["--indirect", "decoded"]
    if arguments.checkpoint:
        model += ["--checkpoint", arguments.checkpoint]
    network, times = render("neural", *model)
    reference, _ = render("reference", "--spp", str(arguments.spp), "--seed", "7")
    mask = luminance(np.abs(reference["normal"])) > 0
    wanted = reference[""][mask]
    unit = wanted.mean() or 1  # figures do not depend on the brightness of the lights
    rate = render("reference", "--spp", "16")[1]
    trace = max(rate["total"] - rate["load"] - rate["write"] - rate["primary"], 1e-9) / 16
    _, filtering = denoise(network[""], network["albedo"], network["normal"])
    rows = [(f"network ({sum(times[s] for s in STAGES['neural']):.2f} s)",
             scores(network[""][mask] / unit, wanted / unit))]
    for budget, stages in STAGES.items():
        left = sum(times[stage] for stage in stages) - rate["primary"] - filtering
        paths = max(1, int(left / trace))
        traced = render("reference", "--spp", str(paths), "--seed", "3")[0]
        smooth, _ = denoise(traced[""], traced["albedo"], traced["normal"])
        note = "" if left >= trace else ", over the budget"
        label = "scene anew" if budget == "neural" else budget
        rows.append((f"{paths} paths ({label}{note})", scores(traced[""][mask] / unit,
                                                              wanted / unit)))
        rows.append((f"{paths} paths, denoised", scores(smooth[mask] / unit, wanted / unit)))
        # What is left when the network's answer is divided out may be smoother than light itself.
        divisor = network[""] + 0.01 * unit
        ratio, _ = denoise(traced[""] / divisor, traced["albedo"], traced["normal"])
        rows.append((f"{paths} paths over the network's, denoised",
                     scores((ratio * divisor)[mask] / unit, wanted / unit)))
    print(
        f"{arguments.scene}, {arguments.size}: irradiance over its mean; {arguments.spp} paths as "
        f"the reference; "
        f"a path a pixel takes {1e3 * trace:.1f} ms, denoising {1e3 * filtering:.1f} ms")
    print_rows(rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", nargs="?")
    parser.add_argument("--data", help="baked data set")
    parser.add_argument("--split", default="test")
    parser.add_argument("--eval", help="lte_eval's JSON of the same scenes")
    parser.add_argument("--size", default="512x512")
    parser.add_argument("--checkpoint")
    parser.add_argument("--camera")
    parser.add_argument("--spp", type=int, default=1024, help="paths of the reference")
    parser.add_argument("--build", default="build")
    arguments = parser.parse_args()
    if bool(arguments.scene) == bool(arguments.data):
        parser.error("expected a scene or --data")
    of_scene(arguments) if arguments.scene else of_data(arguments)


if __name__ == "__main__":
    main()
