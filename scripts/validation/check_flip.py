#!/usr/bin/env python3
"""Holds FLIP and HDR-FLIP against their authors' own program, NVIDIA's flip-evaluator.

usage: scripts/validation/check_flip.py [--write] [--build build]

It needs PyPI's flip-evaluator and numpy.

The program's error maps of a small pair of pictures are kept in tests/image/flip_witness.json,
which the tests hold lte to. This script runs the program afresh, compares with that file, and runs
those tests. --write replaces the file.
"""
import argparse
import importlib.metadata
import json
import pathlib
import subprocess
import sys

import flip_evaluator
import numpy as np

WITNESS = pathlib.Path(__file__).resolve().parents[2] / "tests" / "image" / "flip_witness.json"
WIDTH, HEIGHT = 32, 24
HDR_SCALE = 12  # linear radiance is this times the cube of byte / 255


def pictures():
    """Reference and test, [H, W, 3] bytes: ramps, an edge, a highlight, a dark half; against them a
    moved edge, a tint, noise and a missing highlight."""
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH]
    reference = np.stack([40 + 5 * x, 200 - 6 * y, 60 + 2 * x + 3 * y], -1)
    reference[:, 18:] //= 4
    reference[5:7, 5:7] = 255
    test = np.stack([44 + 5 * x, 196 - 6 * y, 50 + 2 * x + 3 * y], -1)
    test[:, 20:] //= 4
    noise = (np.arange(HEIGHT * WIDTH * 3).reshape(HEIGHT, WIDTH, 3) * 7919 % 31) - 15
    test[12:] += noise[12:]
    test[18:, :8] = 255 - test[18:, :8]
    return np.clip(reference, 0, 255), np.clip(test, 0, 255)


def outside():
    reference, test = pictures()
    ldr = [(p / 255).astype(np.float32) for p in (reference, test)]
    hdr = [((p / 255) ** 3 * HDR_SCALE).astype(np.float32) for p in (reference, test)]
    ldr_map, ldr_mean, ldr_parameters = flip_evaluator.evaluate(*ldr, "LDR", applyMagma=False)
    hdr_map, hdr_mean, hdr_parameters = flip_evaluator.evaluate(*hdr, "HDR", applyMagma=False)
    flat = lambda values: [
        round(float(v), 6) for v in np.asarray(values).reshape(HEIGHT * WIDTH, -1)[:, 0]
    ]
    return {
        "program": "flip-evaluator " + importlib.metadata.version("flip-evaluator"),
        "width": WIDTH,
        "height": HEIGHT,
        "hdr_scale": HDR_SCALE,
        "reference": reference.reshape(-1).tolist(),
        "test": test.reshape(-1).tolist(),
        "ldr": {
            "mean": float(ldr_mean), "map": flat(ldr_map),
            "parameters": {k: str(v) for k, v in ldr_parameters.items()}
        },
        "hdr": {
            "mean": float(hdr_mean), "map": flat(hdr_map),
            "parameters": {k: str(v) for k, v in hdr_parameters.items()}
        },
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true", help="replace the witness")
    parser.add_argument("--build", default="build", help="build folder with bin/lte_image_test")
    arguments = parser.parse_args()
    now = outside()
    if arguments.write:
        WITNESS.write_text(json.dumps(now, separators=(",", ":")) + "\n")
        print(f"wrote {WITNESS}")
    kept = json.loads(WITNESS.read_text())
    for kind in ("ldr", "hdr"):
        worst = np.abs(np.array(now[kind]["map"]) - np.array(kept[kind]["map"])).max()
        print(
            f"{kind}: mean {now[kind]['mean']:.6f}, {now['program']} against {kept['program']}: "
            f"{worst:.1e} apart at most"
        )
        if worst > 1e-4:
            return 1
    return subprocess.run([f"{arguments.build}/bin/lte_image_test",
                           "--gtest_filter=*Flip*"]).returncode


if __name__ == "__main__":
    sys.exit(main())
