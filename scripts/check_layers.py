#!/usr/bin/env python3
"""Fails on an include that points up the layers, or into another folder's cpu/ or cuda/.

The order is the contract of the repository: a folder may include itself and what stands right of it here.
"""
import pathlib
import re
import sys

ALLOWED = {
    "lte/base": [],
    "lte/image": ["lte/base"],
    "lte/scene": ["lte/base", "lte/image"],
    "lte/pathtrace": ["lte/base", "lte/image", "lte/scene"],
    "lte/data": ["lte/base"],
    "lte/ops": ["lte/base"],
    "lte/nn": ["lte/base", "lte/ops"],
    "lte/c_api": ["lte/base", "lte/ops", "lte/nn", "lte/data"],
    "datagen": ["lte/base", "lte/image", "lte/scene", "lte/pathtrace", "lte/data"],
    "train": ["lte/base", "lte/ops", "lte/nn", "lte/data"],
    "infer": ["lte/base", "lte/image", "lte/scene", "lte/pathtrace", "lte/data", "lte/ops", "lte/nn"],
}
NO_TORCH = {"lte/base", "lte/image", "lte/scene", "lte/pathtrace", "lte/data", "datagen"}
OWN_INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"')
TORCH_INCLUDE = re.compile(r"^\s*#\s*include\s*<(torch|ATen|c10)/([^>]+)>")
SUFFIXES = {".h", ".cpp", ".cu", ".cuh"}


def folder_of(path: str) -> str | None:
    """The layer a root-relative path belongs to; lte/c_api.h, which C programs include, is lte/c_api's."""
    parts = path.removesuffix(".h").split("/")
    for depth in (2, 1):
        name = "/".join(parts[:depth])
        if name in ALLOWED:
            return name
    return None


def violations(root: pathlib.Path):
    for layer, below in ALLOWED.items():
        for file in sorted(p for p in (root / layer).rglob("*") if p.suffix in SUFFIXES):
            name = file.relative_to(root).as_posix()
            for number, line in enumerate(file.read_text().splitlines(), 1):
                where = f"{name}:{number}"
                if torch := TORCH_INCLUDE.match(line):
                    if layer in NO_TORCH:
                        yield f"{where}: {layer} must not include LibTorch"
                    if torch.group(2) == "torch.h" and file.suffix != ".cpp" and file.name != "pch.h":
                        yield f"{where}: headers and .cu files include narrow headers, not torch/torch.h"
                if not (own := OWN_INCLUDE.match(line)):
                    continue
                target = folder_of(own.group(1))
                if target is None:
                    yield f'{where}: "{own.group(1)}" is not root-relative (start with lte/, datagen/, train/ or infer/)'
                elif target != layer and target not in below:
                    yield f"{where}: {layer} must not include {target}"
                elif re.match(r"lte/ops/(cpu|cuda)/", own.group(1)) and layer != "lte/ops":
                    yield f"{where}: operators are reached through the dispatcher, not through {own.group(1)}"


def main() -> int:
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
    found = list(violations(root))
    print("\n".join(found) if found else "layers: every include points down")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
