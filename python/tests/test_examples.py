"""The examples run, and say what they should."""
import pathlib
import re
import subprocess
import sys
import urllib.request

import pytest

import lte

EXAMPLES = pathlib.Path(__file__).parents[1] / "examples"
THREE = pathlib.Path(__file__).parents[2] / ".venv" / "tests" / "three.js"


def run(name, folder, *words):
    return subprocess.run([sys.executable, EXAMPLES / name, *words], cwd=folder, text=True,
                          check=True, capture_output=True).stdout


def figure(pattern, text):
    return float(re.search(pattern, text).group(1))


def test_first_picture(tmp_path):
    said = run("first_picture.py", tmp_path, "--size", "32x24")
    assert (tmp_path / "room.png").stat().st_size > 500 and "living_room" in said


def test_light_at_points(tmp_path):
    said = run("light_at_points.py", tmp_path, "--points", "300", "--rays", "512")
    assert figure(r"median error of gathered light: ([\d.]+) %", said) < 10


def test_learn_a_room(tmp_path):
    pytest.importorskip("torch")
    said = run("learn_a_room.py", tmp_path, "--points", "3000", "--rays", "128")
    network, constant = (float(share) for share in re.findall(r"([\d.]+) %", said))
    assert network < 0.5 * constant


@pytest.mark.skipif(not hasattr(lte._lte, "bake"), reason="built without xatlas")
def test_bake_and_view(tmp_path):
    said = run("bake_and_view.py", tmp_path, "--texels-per-metre", "2")
    assert figure(r"(\d+) texels with light", said) > 300
    assert (tmp_path / "baked" / "scene_unlit.glb").stat().st_size > 10000
    if not THREE.exists():
        pytest.skip("no three.js: scripts/setup.sh --tests")
    page = subprocess.Popen([sys.executable, EXAMPLES / "bake_and_view.py", "--texels-per-metre",
                             "1", "--three", THREE, "--once"], cwd=tmp_path, text=True,
                            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    for line in page.stdout:
        if line.startswith("http"):
            break
    with urllib.request.urlopen(line.strip(), timeout=20) as index:
        assert b"<html" in index.read()
    assert page.wait(timeout=20) == 0


def test_dim_lamps(tmp_path):
    said = run("dim_lamps.py", tmp_path, "--rays", "1024", "--lux", "300")
    assert abs(figure(r"after: (\d+) lux", said) - 300) < 15
    before, after = (float(share) for share in re.findall(r"darkest tenth ([\d.]+)", said))
    assert after > before
