"""A small room, and the command-line tools of the same build.

LTE_TOOLS names the folder of lte_render, lte_probe and lte_datagen; without it, what compares with
them is skipped. Denoising is off where bits are compared: which denoiser there is depends on the
machine.
"""
import os
import pathlib
import signal
import subprocess
import sys
import time

os.environ["LTE_OIDN"] = "off"

import pytest  # noqa: E402

import lte  # noqa: E402

MATERIALS = """
newmtl grey
Kd 0.5 0.5 0.5
newmtl lamp
Kd 0 0 0
Ke 5 4 3
"""
ROOM = """
mtllib room.mtl
v -2 0 -2
v 2 0 -2
v 2 0 2
v -2 0 2
v -0.5 2 -0.5
v 0.5 2 -0.5
v 0.5 2 0.5
v -0.5 2 0.5
v -2 3 -2
v -2 3 2
usemtl grey
f 4 3 2 1
f 1 9 10 4
usemtl lamp
f 5 6 7 8
"""


@pytest.fixture(scope="session")
def room_file(tmp_path_factory):
    """A floor and a wall under a lamp of 1 m² that shines from both sides, 2 m above the floor."""
    folder = tmp_path_factory.mktemp("room")
    (folder / "room.mtl").write_text(MATERIALS)
    (folder / "room.obj").write_text(ROOM)
    return folder / "room.obj"


@pytest.fixture(scope="session")
def room(room_file):
    return lte.load(room_file)


@pytest.fixture(scope="session")
def points(room):
    return room.sample(40, seed=3)


@pytest.fixture
def tool():
    """Runs a tool: tool("lte_render", ...)."""
    folder = os.environ.get("LTE_TOOLS")
    if folder is None:
        pytest.skip("LTE_TOOLS names no folder")

    def run(name, *words):
        subprocess.run([pathlib.Path(folder) / name, *map(str, words), "--quiet"], check=True)

    run.folder = pathlib.Path(folder).resolve()
    return run


# A process that was started in the background ignores Ctrl-C, and so do its children.
WORK = """
import itertools, signal, sys, time, lte
signal.signal(signal.SIGINT, signal.default_int_handler)
scene = lte.load(lte.living_room)
seed = itertools.count()
{before}
print("ready", flush=True)
try:
    while True:
        {call}
except KeyboardInterrupt:
    print(time.time(), flush=True)
{after}
"""


@pytest.fixture
def interrupted():
    """Runs a call over and over, sends Ctrl-C, and fails unless it ends soon and all goes on."""
    def run(call, *arguments, before="", after="", seconds=5):
        code = WORK.format(call=call, before=before, after=after)
        work = subprocess.Popen([sys.executable, "-c", code, *arguments], text=True,
                                stdout=subprocess.PIPE)
        assert work.stdout.readline() == "ready\n"
        time.sleep(1)
        sent = time.time()
        work.send_signal(signal.SIGINT)
        ended = float(work.stdout.readline())
        assert work.wait() == 0
        # A fifth of a second on an idle machine.
        assert ended - sent < float(os.environ.get("LTE_SECONDS", seconds))
    return run


@pytest.fixture
def resident_mb():
    def measure():
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6
    return measure
