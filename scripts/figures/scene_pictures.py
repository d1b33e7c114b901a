#!/usr/bin/env python3
"""Makes a sheet of what lte_scene_pictures rendered: denoised, tone mapped, side by side.

usage: scripts/figures/scene_pictures.py FOLDER OUT.jpg|.png [COLUMNS]

It needs PyPI's numpy, Pillow and pyoidn.
"""
import glob
import sys

import numpy as np
import pyoidn
from PIL import Image


def read_pfm(path):
    """[height, width, 3] float32, row 0 on top."""
    with open(path, "rb") as file:
        assert file.readline() == b"PF\n", path
        width, height = map(int, file.readline().split())
        file.readline()
        return np.frombuffer(file.read(), "<f4").reshape(height, width, 3)[::-1].copy()


def display(linear):
    """Exposed for the middle tones, highlights rolled off, sRGB."""
    luminance = linear @ np.array([0.2126, 0.7152, 0.0722], "f4")
    linear = linear * (0.32 / max(np.quantile(luminance, 0.6), 1e-6))
    linear = np.where(linear < 0.5, linear, 1 - 0.5 * np.exp(-(linear - 0.5) / 0.5))
    coded = np.where(linear < 0.0031308, 12.92 * linear,
                     1.055 * np.maximum(linear, 0) ** (1 / 2.4) - 0.055)
    return (255 * np.clip(coded, 0, 1) + 0.5).astype(np.uint8)


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    columns = int(sys.argv[3]) if len(sys.argv) == 4 else 4
    views = []
    for path in sorted(glob.glob(f"{sys.argv[1]}/*_color.pfm")):
        color, albedo, normal = (
            read_pfm(path.replace("color", kind)) for kind in ("color", "albedo", "normal"))
        views.append(display(pyoidn.denoise(color, albedo=albedo, normal=normal, hdr=True)))
    if not views:
        sys.exit(f"{sys.argv[1]}: no *_color.pfm; lte_scene_pictures writes them")
    rows = [
        np.concatenate(views[i:i + columns], axis=1)
        for i in range(0, len(views) - len(views) % columns, columns)
    ]
    Image.fromarray(np.concatenate(rows)).save(
        sys.argv[2], **({"quality": 90} if sys.argv[2].endswith(".jpg") else {}))


if __name__ == "__main__":
    main()
