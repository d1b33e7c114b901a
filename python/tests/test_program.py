"""The tools as the program `lte`."""
import re
import signal
import subprocess
import sys
import urllib.request

import pytest

import lte

LTE = [sys.executable, "-m", "lte"]


def run(*words):
    return subprocess.run([*LTE, *map(str, words)], text=True, capture_output=True)


def test_it_says_what_there_is():
    bare, helped, wrong = run(), run("--help"), run("rendr")
    assert (bare.returncode, helped.returncode, wrong.returncode) == (2, 0, 2)
    assert "lte render" in helped.stdout and bare.stderr == helped.stdout
    assert "rendr" in wrong.stderr and lte.__version__ in run("--version").stdout


def test_tools_are_those_of_the_build(room_file, tmp_path, tool):
    words = [room_file, "--size", "16x12", "--quality", "draft", "--set", "denoise=off", "--out"]
    tool("lte_render", *words, tmp_path / "tool.exr")
    assert run("render", *words, tmp_path / "python.exr").returncode == 0
    assert (tmp_path / "python.exr").read_bytes() == (tmp_path / "tool.exr").read_bytes()


def test_bad_input_is_one_line_and_1(tmp_path):
    for words in (["render", "no.glb"], ["info", "no.glb"],
                  ["probe", lte.living_room, "--points", "no.csv", "--out", tmp_path / "a.csv"]):
        ended = run(*words)
        assert ended.returncode == 1 and ended.stderr.count("\n") == 1
    assert run("render", "--sizes").returncode == 2


def test_the_network_is_that_of_the_package(room_file, tmp_path):
    words = ["render", room_file, "--integrator", "network", "--size", "16x12", "--quality",
             "draft", "--quiet"]
    assert run(*words, "--out", tmp_path / "a.exr").returncode == 0
    assert run(*words, "--checkpoint", lte.living_room.parents[1] / "models/lte.safetensors",
               "--out", tmp_path / "b.exr").returncode == 0
    assert (tmp_path / "a.exr").read_bytes() == (tmp_path / "b.exr").read_bytes()


def test_eval_needs_no_torch():
    assert "--checkpoint" in run("eval", "--help").stdout and "lte eval" in run("--help").stdout
    ended = run("eval", "--data", "no-data", "--split", "test", "--quiet")
    assert ended.returncode == 1 and ended.stderr.count("\n") == 1 and "no-data" in ended.stderr


def test_a_tool_that_needs_torch_says_so():
    for name in ("train", "export", "bench"):
        ended = run(name, "--help")
        assert ended.returncode == 1 and ended.stderr.count("\n") == 1
        assert f"{name} needs LibTorch" in ended.stderr
        assert f"lte {name}" not in run("--help").stdout


def test_demo_is_a_picture(tmp_path):
    words = ["--quality", "draft", "--size", "32x24", "--quiet"]
    ended = run("demo", *words, "--out", tmp_path / "demo.png")
    assert ended.returncode == 0, ended.stderr
    assert run("render", lte.living_room, *words, "--out", tmp_path / "room.png").returncode == 0
    assert (tmp_path / "demo.png").read_bytes() == (tmp_path / "room.png").read_bytes()


def test_links_to_the_program_are_tools(tmp_path, tool):
    program = tool.folder / "lte"
    (tmp_path / "lte_probe").symlink_to(program)
    said = [subprocess.run(words, text=True, capture_output=True, check=True).stdout
            for words in ([program, "probe", "--help"], [tmp_path / "lte_probe", "--help"],
                          [tool.folder / "lte_probe", "--help"])]
    assert said[0] == said[1] == said[2] and "--points" in said[0]
    assert f"lte {lte.__version__}\n" == subprocess.run(
        [program, "--version"], text=True, capture_output=True, check=True).stdout


def test_info_and_data(room_file, tmp_path):
    assert "name: room\n" in run("info", room_file).stdout
    assert "generate" in run("data", "--help").stdout


def test_view_serves_its_page(room_file):
    view = subprocess.Popen([*LTE, "view", room_file, "--port", "0"], text=True,
                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    for line in view.stdout:
        if found := re.search(r"http://\S+", line):
            break
    with urllib.request.urlopen(found.group(0), timeout=20) as page:
        assert b"<html" in page.read()
    view.send_signal(signal.SIGINT)
    view.stdout.read()
    assert view.wait(timeout=20) in (0, 130, -signal.SIGINT)


def test_a_scene_is_viewed_while_its_page_is_open(room):
    with lte.view(room) as page:
        with urllib.request.urlopen(page.url, timeout=20) as served:
            assert b"<html" in served.read()
    with pytest.raises(OSError):
        urllib.request.urlopen(page.url, timeout=5)
    with pytest.raises(TypeError, match="scene: expected lte.Scene"):
        lte.view("room.glb")
