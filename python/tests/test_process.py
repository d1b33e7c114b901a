"""The package in a process: threads, forks, Ctrl-C, memory."""
import os
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import lte


def test_threads_share_a_scene(room, points):
    want = lte.trace.irradiance(room, *points, rays=64).total
    options = {"size": (16, 16), "quality": "draft", "camera": "auto", "denoise": False}
    picture = lte.render(room, **options).color
    found = []

    def ask():
        for _ in range(5):
            found.append(np.array_equal(lte.trace.irradiance(room, *points, rays=64).total, want))
            found.append(np.array_equal(lte.render(room, **options).color, picture))

    workers = [threading.Thread(target=ask) for _ in range(4)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert len(found) == 40 and all(found)


def test_other_threads_run_meanwhile(room, points):
    """What another thread gets done while a call is at work shows that the call holds no lock."""
    done = threading.Event()
    work = threading.Thread(
        target=lambda: (lte.trace.irradiance(room, *points, rays=1 << 15), done.set()))
    work.start()
    turns = 0
    while not done.is_set():
        turns += 1
        time.sleep(0.001)
    work.join()
    assert turns > 3


def run(code, *words):
    return subprocess.run([sys.executable, "-c", code, *map(str, words)], text=True,
                          capture_output=True, timeout=120)


def test_a_forked_process_answers():
    """With a scene of its parent, and with one of its own."""
    code = ("import os, sys, lte; s = lte.load(sys.argv[1]); p = s.sample(9)\n"
            "want = lte.trace.irradiance(s, *p, rays=64).total; pid = os.fork()\n"
            "if pid == 0:\n"
            "    same = (lte.trace.irradiance(s, *p, rays=64).total == want).all()\n"
            "    s = lte.load(sys.argv[1])\n"
            "    own = (lte.trace.irradiance(s, *p, rays=64).total == want).all()\n"
            "    os._exit(7 if same and own else 1)\n"
            "sys.exit(os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]))")
    assert run(code, lte.living_room).returncode == 7


def test_scenes_in_globals_end_quietly():
    ended = run("import sys, lte; s = lte.load(sys.argv[1]); p = lte.render(s, size=(8, 8))",
                lte.living_room)
    assert ended.returncode == 0 and ended.stderr == ""


@pytest.mark.parametrize("call", [
    "lte.render(scene, size=(640, 480), integrator='path', spp=4096).save(sys.argv[1])",
    "lte.render(scene, size=(1280, 960), seed=next(seed)).save(sys.argv[1])",
    "lte.irradiance(scene, points, normals)",
    "lte.trace.irradiance(scene, points, normals, rays=65536)",
    "lte.generate_scene('homes', seed=next(seed))"])
def test_ctrl_c_ends_work(interrupted, call, tmp_path):
    interrupted(call, tmp_path / "a.exr", before="points, normals = scene.sample(2000)",
                after="scene.sample(3)")
    assert not list(tmp_path.iterdir())


def test_calls_leave_no_memory(room, resident_mb):
    """LTE_CALLS=100000 takes minutes."""
    calls = int(os.environ.get("LTE_CALLS", 2000))
    point = np.zeros((1, 3), np.float32), np.float32([[0, 1, 0]])

    def ask(count):
        for _ in range(count):
            lte.trace.irradiance(room, *point, rays=2, depth=1)
        for _ in range(count // 100):
            lte.load(lte.living_room).sample(5)

    ask(max(calls // 5, 1000))
    before = resident_mb()
    ask(calls)
    assert resident_mb() - before < 2
