#!/usr/bin/env python3
"""Fails on an include that points up the layers, or into another folder's cpu/ or cuda/.

The order is the contract of the repository (docs/architecture.md). A room, that is a folder or a
single unit that has rules of its own, may include itself and the rooms that its line names; a
name that ends in /* stands for a folder and all below it. The folder experiments may include
everything, and nothing includes it.

Fails, too, where LibTorch comes in, through however many headers, above the .cpp files of
lte/runtime; where an importer of scenes opens a file by itself; and where a tool loads a scene
without the flags that say what it may read.
"""
import functools
import pathlib
import re
import sys

LIBRARY_WITHOUT_TORCH = ["lte/base", "lte/image", "lte/scene/*", "lte/pathtrace/*", "lte/data"]

ALLOWED = {
    "lte/base": [],
    "lte/cli": ["lte/base"],
    # The flags of tools that load scenes, a target of its own.
    "lte/cli/scene_flags": ["lte/base", "lte/scene", "lte/scene/import", "lte/scene/load"],
    # Which scene a tool works on.
    "lte/cli/scene_source": ["lte/base", "lte/cli/*", "lte/scene", "lte/scene/import",
                             "lte/scene/load_camera", "lte/scene/up_axis",
                             "lte/pathtrace/placement"],
    "lte/report": ["lte/base"],
    "lte/image": ["lte/base"],
    # What others include, then the importers. lte/scene/load alone knows them all, and none of them
    # includes it.
    "lte/scene": ["lte/base", "lte/image"],
    "lte/scene/import": ["lte/base", "lte/image", "lte/scene"],
    "lte/scene/gltf": ["lte/base", "lte/scene", "lte/scene/import"],
    "lte/scene/obj": ["lte/base", "lte/image", "lte/scene", "lte/scene/import"],
    "lte/scene/ply": ["lte/base", "lte/image", "lte/scene", "lte/scene/import"],
    "lte/scene/pbrt": ["lte/base", "lte/image", "lte/scene", "lte/scene/import", "lte/scene/ply"],
    "lte/scene/load": ["lte/base", "lte/scene/*"],
    "lte/scene/inspect": ["lte/base", "lte/scene"],
    "lte/pathtrace": ["lte/base", "lte/image", "lte/scene/*", "lte/pathtrace/*"],
    "lte/pathtrace/materials": ["lte/base", "lte/scene/*", "lte/pathtrace"],
    "lte/pathtrace/blocks": ["lte/base", "lte/scene/*", "lte/pathtrace",
                             "lte/pathtrace/materials"],
    "lte/pathtrace/lights": ["lte/base", "lte/image", "lte/scene/*", "lte/pathtrace",
                             "lte/pathtrace/blocks"],
    "lte/pathtrace/transport": ["lte/base", "lte/scene/*", "lte/pathtrace",
                                "lte/pathtrace/materials", "lte/pathtrace/blocks",
                                "lte/pathtrace/lights"],
    "lte/pathtrace/incident": ["lte/base", "lte/image", "lte/scene/*", "lte/pathtrace",
                               "lte/pathtrace/materials", "lte/pathtrace/lights",
                               "lte/pathtrace/transport"],
    # What rays find out about a scene before its light is traced: where light can come, and where
    # a camera and a lamp may stand.
    "lte/pathtrace/reach": ["lte/base", "lte/scene/*", "lte/pathtrace", "lte/pathtrace/lights",
                            "lte/pathtrace/transport"],
    "lte/pathtrace/placement": ["lte/base", "lte/scene/*", "lte/pathtrace"],
    "lte/gi": ["lte/base", "lte/image", "lte/scene/*", "lte/pathtrace/*"],
    # Pictures: integrators, films, passes.
    "lte/render": ["lte/base", "lte/image", "lte/scene/*", "lte/pathtrace/*", "lte/gi"],
    # Light maps and probes, then the files that engines take.
    "lte/bake": ["lte/base", "lte/image", "lte/scene/*", "lte/pathtrace/*", "lte/gi",
                 "lte/render"],
    "lte/bake/formats": ["lte/base", "lte/image", "lte/scene/*", "lte/pathtrace/*", "lte/bake"],
    "lte/data": ["lte/base"],
    "lte/radiosity": ["lte/base"],
    # Which tensors: those of LibTorch, or in builds without it our own.
    "lte/tensor": ["lte/base", "lte/tensor/own"],
    "lte/tensor/own": ["lte/base"],
    "lte/ops": ["lte/base", "lte/tensor", "lte/radiosity", "lte/ops/cpu/*"],
    "lte/ops/cpu/kernels": ["lte/base", "lte/tensor", "lte/ops"],
    "lte/ops/cpu/search": ["lte/base", "lte/tensor", "lte/ops", "lte/ops/cpu/kernels"],
    "lte/ops/cpu/dense": ["lte/base", "lte/tensor", "lte/ops", "lte/ops/cpu/kernels"],
    "lte/ops/cpu/attention": ["lte/base", "lte/tensor", "lte/ops", "lte/ops/cpu/kernels",
                              "lte/ops/cpu/dense"],
    "lte/ops/cpu/convolution": ["lte/base", "lte/tensor", "lte/ops", "lte/ops/cpu/kernels",
                                "lte/ops/cpu/dense"],
    "lte/ops/cpu/neighbours": ["lte/base", "lte/tensor", "lte/ops", "lte/ops/cpu/kernels",
                               "lte/ops/cpu/dense"],
    "lte/ops/cpu/decoder": ["lte/base", "lte/tensor", "lte/ops", "lte/ops/cpu/kernels",
                            "lte/ops/cpu/dense"],
    "lte/ops/cpu/radiosity": ["lte/base", "lte/tensor", "lte/radiosity", "lte/ops"],
    "lte/ops/cuda": ["lte/base", "lte/tensor", "lte/radiosity", "lte/ops"],
    "lte/nn": ["lte/base", "lte/tensor", "lte/ops", "lte/nn/*"],
    "lte/nn/config": ["lte/base", "lte/ops"],
    "lte/nn/constants": ["lte/base", "lte/ops"],
    "lte/nn/blocks": ["lte/base", "lte/tensor", "lte/ops", "lte/nn/constants"],
    "lte/nn/points": ["lte/base", "lte/tensor", "lte/ops", "lte/nn/config", "lte/nn/constants"],
    "lte/nn/encoder": ["lte/base", "lte/tensor", "lte/ops", "lte/nn/config", "lte/nn/constants",
                       "lte/nn/blocks"],
    "lte/nn/decoder": ["lte/base", "lte/tensor", "lte/ops", "lte/nn/config", "lte/nn/constants",
                       "lte/nn/blocks", "lte/nn/points", "lte/nn/encoder"],
    "lte/nn/files": ["lte/base", "lte/tensor", "lte/nn", "lte/nn/config"],
    "lte/runtime": ["lte/base", "lte/tensor", "lte/ops", "lte/nn/*", "lte/data"],
    # Scene files to embeddings.
    "lte/embed": ["lte/base", "lte/scene/*", "lte/pathtrace/*", "lte/data", "lte/radiosity",
                  "lte/runtime"],
    "lte/torchscript": ["lte/base", "lte/radiosity", "lte/ops", "lte/nn/*"],
    "lte/c_render": ["lte/c_api"],
    "lte/c_api": ["lte/c_render", "lte/base", "lte/image", "lte/scene/*", "lte/pathtrace/*",
                  "lte/render", "lte/runtime", "lte/embed"],
    "datagen/common": LIBRARY_WITHOUT_TORCH,
    "datagen/boxes": LIBRARY_WITHOUT_TORCH + ["datagen/common"],
    "datagen/homes": LIBRARY_WITHOUT_TORCH + ["datagen/common", "datagen/homes/*"],
    "datagen/homes/furniture": LIBRARY_WITHOUT_TORCH + ["datagen/common", "datagen/homes/*"],
    "datagen/homes/mesh": LIBRARY_WITHOUT_TORCH + ["datagen/common"],
    "datagen/homes/textures": LIBRARY_WITHOUT_TORCH + ["datagen/common"],
    "datagen/wild": LIBRARY_WITHOUT_TORCH + ["datagen/common", "datagen/homes/*"],
    "datagen/bake": LIBRARY_WITHOUT_TORCH + ["lte/cli"],
    "datagen/dataset": LIBRARY_WITHOUT_TORCH + ["lte/cli/*", "datagen/common", "datagen/bake",
                                                "datagen/boxes", "datagen/homes", "datagen/wild"],
    "datagen/commands": LIBRARY_WITHOUT_TORCH + ["lte/cli/*", "datagen/bake", "datagen/dataset"],
    "datagen": LIBRARY_WITHOUT_TORCH + ["lte/cli", "datagen/commands"],
    "train/config": ["lte/base", "lte/ops", "lte/nn/*", "lte/data"],
    "train/log": ["lte/base", "lte/image"],
    "train/distributed": ["lte/base"],
    "train/optim": ["lte/base", "lte/ops", "lte/nn/*", "train/config"],
    "train/data": ["lte/base", "lte/cli", "lte/radiosity", "lte/nn/*", "lte/data", "train/config",
                   "train/distributed"],
    "train/checkpoint": ["lte/base", "lte/nn/*", "lte/data", "train/config", "train/data",
                         "train/optim"],
    "train/loop": ["lte/base", "lte/cli", "lte/image", "lte/ops", "lte/nn/*", "lte/data",
                   "train/config", "train/log", "train/distributed", "train/optim", "train/data",
                   "train/checkpoint"],
    # One scene by heart.
    "train/fit": ["lte/base", "lte/scene/*", "lte/pathtrace/*", "lte/nn/*", "lte/runtime"],
    "train/command": ["lte/base", "lte/cli/*", "lte/ops", "lte/nn/*", "lte/data", "lte/embed",
                      "train/config", "train/log", "train/distributed", "train/optim",
                      "train/loop", "train/fit"],
    "train": ["lte/base", "lte/cli", "train/command"],
}
# What the tools with a network stand on, each room on those before it.
INFER = LIBRARY_WITHOUT_TORCH + ["lte/gi", "lte/render", "lte/radiosity", "lte/cli/*",
                                 "lte/runtime", "lte/embed"]
INFER_SHARED = ["infer/tool", "infer/check", "infer/picture", "infer/renderer"]
for depth, room in enumerate(INFER_SHARED):
    ALLOWED[room] = INFER + INFER_SHARED[:depth]
# A scene in memory that takes edits: for the tools that show one.
ALLOWED["infer/session"] = INFER + INFER_SHARED
# Render, probe, bake, eval and export never include one another.
for tool in ("render", "probe", "bake", "eval", "export"):
    ALLOWED[f"infer/{tool}"] = INFER + INFER_SHARED + ["lte/report"]
# The rooms of eval, each on those before it: how errors are measured, what the network is compared
# with, the comparison, and what is said of it.
EVAL = ["infer/eval/measure", "infer/eval/baselines", "infer/eval/evaluate", "infer/eval/report",
        "infer/eval/scenes"]
for depth, room in enumerate(EVAL):
    ALLOWED[room] = ALLOWED["infer/eval"] + EVAL[:depth]
ALLOWED["infer/eval"] += EVAL
ALLOWED["infer/export"] += ["lte/torchscript", "lte/nn/*"]
ALLOWED["infer/render"] += ["infer/session"]
ALLOWED["infer/bake"] += ["lte/bake", "lte/bake/formats"]
# lte_bench times everything below it, and draws the chart of lte_render's pictures.
ALLOWED["bench"] = (INFER + INFER_SHARED +
                    ["lte/nn/*", "lte/ops", "lte/report", "lte/bake", "infer/render", "infer/bake",
                     "bench/*"])
ALLOWED["bench/pareto"] = ALLOWED["bench"] + ["infer/eval/measure"]
# A live view shows a session in the qualities of lte_render.
ALLOWED["infer/view"] = ALLOWED["infer/render"] + ["infer/render"]

# The program lte knows the tools by their mains alone. The Python module is thin over what the
# tools are thin over.
ALLOWED["program"] = ["lte/base", "lte/cli/*", "program/about"]
# What it has, down to the instruction set of its kernels.
ALLOWED["program/about"] = ["lte/base", "lte/cli", "lte/image", "lte/ops/cpu/kernels",
                            "lte/scene/load", "program"]
ALLOWED["python/src"] = INFER + INFER_SHARED + [
    "infer/probe", "infer/render", "infer/bake", "lte/bake", "lte/bake/formats", "datagen/dataset",
    "datagen/commands", "program", "program/about"]

NO_TORCH = ("lte/base/", "lte/cli/", "lte/report/", "lte/image/", "lte/scene/", "lte/pathtrace/",
            "lte/gi/", "lte/data/", "lte/radiosity/", "lte/render/", "lte/c_api/", "lte/c_api.h",
            "lte/c_render.h", "lte/embed/",
            "datagen/", "infer/", "program/", "python/", "tests/infer/", "tests/c_api/")
# Memory on a GPU.
TORCH_AFTER_ALL = ("tests/c_api/cuda_test.cpp",)
# lte/runtime is the door: of its headers these are for what is LibTorch's itself.
BEHIND_THE_DOOR = ("lte/runtime/solved_light.h", "lte/runtime/tensors.h",
                   "lte/runtime/torch_errors.h", "lte/runtime/torch_parts.h")
OWN_INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"')
TORCH_INCLUDE = re.compile(r"^\s*#\s*include\s*<(torch|ATen|c10)/([^>]+)>")
CLI_INCLUDE = re.compile(r"^\s*#\s*include\s*<CLI/")
# What a scene names is opened in lte/scene/import/scene_files.cpp and nowhere else, as that alone
# holds it against the scene's folder: importers have no other way to a file.
IMPORTER = re.compile(r"lte/scene/(?!import$|inspect$|load$)\w+$")
FILE_ACCESS = re.compile(
    r"<(fstream|cstdio|stdio\.h|fcntl\.h|unistd\.h|sys/\w+\.h)>|lte/base/(locked_)?file\.h|"
    r"\b(MappedFile|read_file|[io]?fstream|fopen|freopen|opendir|read_picture|read_png|read_exr)"
    r"\s*[({ ]|"
    r"(?<!\w)::open\(|\b(std::filesystem|fs)::(?!path\b)\w+")
SUFFIXES = {".h", ".cpp", ".cu", ".cuh"}


def room_of(path: str) -> str | None:
    """The room of a root-relative path: its unit where that has rules of its own, else its folder.

    lte/c_api.h, which C programs include, is lte/c_api's.
    """
    unit = path.rsplit(".", 1)[0]
    if unit in ALLOWED:
        return unit
    folder = unit.rsplit("/", 1)[0] if "/" in unit else unit
    return folder if folder in ALLOWED else None


def may_include(room: str, target: str) -> bool:
    """Whether a file of `room` may include one of `target`."""
    if room == target:
        return True
    return any(target == name or (name.endswith("/*") and
                                  (target == name[:-2] or target.startswith(name[:-1])))
               for name in ALLOWED[room])


def is_torch_free(name: str) -> bool:
    """Whether a file must not know LibTorch, by its root-relative name."""
    if name.startswith("lte/runtime/"):
        return name.endswith(".h") and name not in BEHIND_THE_DOOR
    return name.startswith(NO_TORCH) and not name.startswith(TORCH_AFTER_ALL)


@functools.lru_cache(maxsize=None)
def way_to_torch(file: pathlib.Path, root: pathlib.Path) -> str:
    """The includes that lead from a file to LibTorch, "" where none do."""
    for line in file.read_text().splitlines() if file.exists() else []:
        if torch := TORCH_INCLUDE.match(line):
            return f"{torch.group(1)}/{torch.group(2)}"
        if (own := OWN_INCLUDE.match(line)) and (way := way_to_torch(root / own.group(1), root)):
            return f"{own.group(1)} -> {way}"
    return ""


def torch_violations(root: pathlib.Path):
    for top in ("lte", "datagen", "infer", "program", "python", "tests"):
        for file in sorted(p for p in (root / top).rglob("*") if p.suffix in SUFFIXES):
            name = file.relative_to(root).as_posix()
            if is_torch_free(name) and (way := way_to_torch(file, root)):
                yield f"{name}: must not include LibTorch, by way of {way}"


def violations(root: pathlib.Path):
    yield from torch_violations(root)
    for top in ("lte", "datagen", "train", "infer", "bench", "program", "python"):
        for file in sorted(p for p in (root / top).rglob("*") if p.suffix in SUFFIXES):
            name = file.relative_to(root).as_posix()
            if name == "lte/lte.h":
                continue
            room = room_of(name)
            if room is None:
                yield f"{name}: this folder has no line in scripts/check_layers.py"
                continue
            yield from violations_of(file, name, room)


def violations_of(file: pathlib.Path, name: str, room: str):
    for number, line in enumerate(file.read_text().splitlines(), 1):
        where = f"{name}:{number}"
        if torch := TORCH_INCLUDE.match(line):
            if torch.group(2) == "torch.h" and file.suffix != ".cpp" and file.name != "pch.h":
                yield f"{where}: headers and .cu files include narrow headers, not torch/torch.h"
        if IMPORTER.match(room) and FILE_ACCESS.search(line.split("//")[0]):
            yield (f"{where}: importers open files through lte/scene/import/scene_files.h alone "
                   f"({line.strip()})")
        if CLI_INCLUDE.match(line) and room.startswith("lte/") and not room.startswith("lte/cli"):
            yield f"{where}: CLI11 is known to lte/cli and the tools alone"
        if not (own := OWN_INCLUDE.match(line)):
            continue
        if own.group(1) == "lte/scene/load.h" and name.startswith(("datagen/", "infer/", "bench/")):
            yield f"{where}: tools load scenes through lte/cli/scene_flags.h"
        target = room_of(own.group(1))
        if own.group(1).startswith("experiments/"):
            yield f"{where}: nothing outside experiments includes them"
        elif target is None:
            yield (f'{where}: "{own.group(1)}" is not root-relative '
                   "(start with lte/, datagen/, train/, infer/ or bench/)")
        elif (re.match(r"lte/ops/(cpu|cuda)/", own.group(1)) and
              not room.startswith("lte/ops") and room != "program/about"):
            yield f"{where}: operators are reached through the dispatcher, not {own.group(1)}"
        elif not may_include(room, target):
            yield f"{where}: {room} must not include {target}"


def main() -> int:
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
    found = list(violations(root))
    print("\n".join(found) if found else "layers: every include points down")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
