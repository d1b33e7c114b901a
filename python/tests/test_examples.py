"""The examples run, and say what they should."""
import pathlib
import re
import subprocess
import sys

EXAMPLES = pathlib.Path(__file__).parents[1] / "examples"


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


def test_dim_lamps(tmp_path):
    said = run("dim_lamps.py", tmp_path, "--rays", "1024", "--lux", "300")
    assert abs(figure(r"after: (\d+) lux", said) - 300) < 15
    before, after = (float(share) for share in re.findall(r"darkest tenth ([\d.]+)", said))
    assert after > before
