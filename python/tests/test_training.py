"""Training and export by the program of lte-torch.

Where that is not installed, LTE_TORCH_PATH names the folders it and torch lie in, else tests skip.
"""
import itertools
import json
import os
import signal
import struct
import subprocess
import sys
import time
from importlib.util import find_spec

import pytest

import lte
from lte import _torch

BOXES = ("scenes: 4\nseed: 5\ngenerator: boxes\nscene_points: 256\nquery_points: 128\nrays: 16\n"
         "evaluation_splits: [val]\n")
SMALL = {"data.scene_points": 128, "data.queries_per_scene": 64, "model.channels": 32,
         "train.log_every": 1, "train.warmup_steps": 1, "train.validate_every": 1000,
         "train.checkpoint_every": 1000, "train.validation_scenes": 1}
INSTALLED = find_spec("lte_torch") is not None
PATHS = os.environ.get("LTE_TORCH_PATH", "").split(":")
WRONG = "__version__ = '2.15.0+cpu'\n"


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    folder = tmp_path_factory.mktemp("training")
    (folder / "boxes.yaml").write_text(BOXES)
    lte.generate_dataset(folder / "boxes.yaml", folder / "boxes")
    return folder / "boxes"


def provide(monkeypatch, *paths):
    for path in reversed(paths):
        monkeypatch.syspath_prepend(str(path))
    words = [*map(str, paths), os.environ.get("PYTHONPATH", "")]
    monkeypatch.setenv("PYTHONPATH", ":".join(filter(None, words)))


@pytest.fixture
def torch(monkeypatch):
    if not INSTALLED and PATHS == [""]:
        pytest.skip("no lte-torch")
    if not INSTALLED:
        provide(monkeypatch, *PATHS)


def train(data, out, steps, **options):
    return lte.train(lte.configs / "train" / "demo.yaml", data=data, out=out, steps=steps,
                     set=SMALL, **options)


def run(*words):
    return subprocess.run([sys.executable, "-m", "lte", *map(str, words)], text=True,
                          capture_output=True)


def weights(path):
    data = path.read_bytes()
    return data[8 + struct.unpack_from("<Q", data)[0]:]


def test_steps_and_losses_then_a_model_to_export(torch, data, tmp_path):
    run_ = train(data, tmp_path / "run", 6)
    said = list(run_)
    assert [step for step, _ in said] == [1, 2, 3, 4, 5, 6]
    lines = map(json.loads, (run_.folder / "log.jsonl").read_text().splitlines())
    assert said == [(line["step"], line["loss"]) for line in lines if "loss" in line]
    assert lte.Model.load(run_.model).encode(lte.generate_scene("boxes")).scene_points > 0
    made = run("export", "--checkpoint", run_.model, "--out", tmp_path / "a.pt")
    assert made.returncode == 0, made.stderr
    assert (tmp_path / "a.pt").stat().st_size > 10000


def test_a_run_that_is_left_goes_on(torch, data, tmp_path):
    """To the figures of one that was not left."""
    with train(data, tmp_path / "left", 8) as left:
        first = list(itertools.islice(left, 3))
    made = len((tmp_path / "left" / "log.jsonl").read_text().splitlines())
    assert 3 <= made < 8 and left.model.exists()
    rest = list(train(data, tmp_path / "left", 8, resume=True))
    whole = list(train(data, tmp_path / "whole", 8))
    assert rest[0][0] == made + 1 and rest[-1][0] == 8
    assert rest == whole[made:] and first == whole[:3]
    assert weights(left.model) == weights(tmp_path / "whole" / "model.safetensors")


def test_ctrl_c_ends_training(torch, data, tmp_path):
    # In the background Ctrl-C is ignored unless the process says otherwise.
    code = ("import signal, sys, time, lte\n"
            "signal.signal(signal.SIGINT, signal.default_int_handler)\ntry:\n"
            "    for step in lte.train(lte.configs / 'train' / 'demo.yaml', data=sys.argv[1],\n"
            f"                          out=sys.argv[2], steps=100000, set={SMALL}):\n"
            "        print('step', flush=True)\n"
            "except KeyboardInterrupt:\n    print('ended', time.time(), flush=True)\n")
    work = subprocess.Popen([sys.executable, "-c", code, data, tmp_path / "run"], text=True,
                            stdout=subprocess.PIPE)
    assert work.stdout.readline() == "step\n"
    sent = time.time()
    work.send_signal(signal.SIGINT)
    last = work.stdout.read().splitlines()[-1].split()
    assert work.wait() == 0 and last[0] == "ended" and float(last[1]) - sent < 10
    assert not [path for path in (tmp_path / "run").rglob("*") if "tmp" in path.name]
    steps = len((tmp_path / "run" / "log.jsonl").read_text().splitlines())
    (step, _), = train(data, tmp_path / "run", steps + 1, resume=True)
    assert step == steps + 1


def test_what_cannot_be_trained_is_an_error(torch, data, tmp_path):
    with pytest.raises(lte.Error, match="no.yaml"):
        lte.train("no.yaml", data=data)
    with pytest.raises(lte.Error, match="train.stepps"):
        lte.train(lte.configs / "train" / "demo.yaml", set={"train.stepps": 3})
    with pytest.raises(lte.Error, match="nowhere"):
        list(train(tmp_path / "nowhere", tmp_path / "run", 2))
    (tmp_path / "file").write_text("")
    with pytest.raises(lte.Error, match="file"):
        list(train(data, tmp_path / "file", 2))
    with pytest.raises(ValueError, match="steps"):
        train(data, tmp_path / "run", 0)
    assert not (tmp_path / "run").exists()


def test_the_program_has_its_tools(torch):
    usage = run("--help").stdout
    for name in ("train", "export", "bench"):
        assert f"lte {name}" in usage and f"lte_{name}" in run(name, "--help").stdout


def test_without_it_a_line_says_what_to_install(monkeypatch):
    if INSTALLED:
        pytest.skip("lte-torch is installed")
    monkeypatch.delitem(sys.modules, "lte_torch", raising=False)
    assert run("train").stderr == "lte: train needs LibTorch: pip install lte[torch]\n"
    with pytest.raises(lte.Error, match=r"pip install lte\[torch\]"):
        lte.train(lte.configs / "train" / "demo.yaml")


@pytest.mark.parametrize("files", [{}, {"__init__.py": ""},
                                   {"__init__.py": "raise ImportError", "version.py": WRONG}])
def test_another_torch_is_one_line(torch, monkeypatch, tmp_path, files):
    """Of another version, of none, and a folder of that name."""
    (tmp_path / "torch").mkdir()
    for name, text in files.items():
        (tmp_path / "torch" / name).write_text(text)
    provide(monkeypatch, tmp_path, *(PATHS[:1] if not INSTALLED else ()))
    found = _torch.Torch()
    if not files and found.program:
        return  # a folder is no package where there is one
    ended = run("train", "--help")
    assert ended.returncode == 1 and ended.stderr.count("\n") == 1
    assert "lte: train needs LibTorch: " in ended.stderr and "'torch==2." in ended.stderr
    if "version.py" in files:
        assert "lte-torch is built for torch 2.11, and torch 2.15.0 is installed" in ended.stderr
    with pytest.raises(lte.Error, match="'torch==2."):
        lte.train(lte.configs / "train" / "demo.yaml")
