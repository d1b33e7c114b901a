"""What the package says of its types, as mypy reads it."""
import os
import pathlib
import subprocess
import sys

import pytest

import lte

pytest.importorskip("mypy")
EXAMPLES = pathlib.Path(__file__).parents[1] / "examples"
WRONG = """
import lte
scene = lte.load(lte.living_room)
scene.lights[0].gain = "half"
scene.lights[b"lamp"]
lte.trace.irradiance(scene, [[0, 0, 0]], [[0, 1, 0]]).nothing
light = lte.Model.load().encode(scene).irradiance([[0, 0, 0]], [[0, 1, 0]])
light, error = lte.Model.load().encode(scene).irradiance([[0, 0, 0]], [[0, 1, 0]], error=True)
lte.render(scene, quality="best")
right: list[str] = [lamp.name for lamp in scene.lights] + list(next(lte.homes()).bake())
"""


def check(*files):
    """What mypy says of the files themselves: of the package it wants programs that may lack."""
    folder = pathlib.Path(lte.__file__).parents[1]
    environment = {**os.environ, "MYPYPATH": "" if "site-packages" in folder.parts else str(folder)}
    said = subprocess.run([sys.executable, "-m", "mypy", "--cache-dir", os.devnull, "--no-color",
                           "--ignore-missing-imports", "--check-untyped-defs", *map(str, files)],
                          env=environment, text=True, capture_output=True).stdout
    names = tuple(file.name for file in files)
    return [line for line in said.splitlines()
            if pathlib.Path(line.split(":")[0]).name in names and ": error: " in line]


def test_examples_have_the_types_of_the_package():
    assert (pathlib.Path(lte.__file__).parent / "py.typed").exists()
    assert not check(*EXAMPLES.glob("*.py"))


def test_wrong_types_are_found(tmp_path):
    (tmp_path / "wrong.py").write_text(WRONG)
    lines = [int(line.split(":")[1]) for line in check(tmp_path / "wrong.py")]
    assert set(lines) == {4, 5, 6, 9}
