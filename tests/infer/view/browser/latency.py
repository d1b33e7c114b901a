#!/usr/bin/env python3
"""Measures lte_view through a WebSocket as a page has it: from sending a message to the first
picture that shows what it asked for. Prints a row a kind of change.

usage: latency.py BUILD SCENE [--size WxH] [--moves N] [--edits N] [--object NAME] [--pages N]
                  [--indirect gather|network|decoded]

Processor seconds of the server stand beside the wall clock, as that depends on what else runs.
"""
import argparse
import json
import math
import os
import pathlib
import random
import select
import statistics
import struct
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from view_server import ViewServer  # noqa: E402
from web_socket import TEXT, WebSocket  # noqa: E402


class Client:
    """A page without a browser: acknowledges every picture and keeps the last header."""

    def __init__(self, server):
        path = "/socket" + (server.address.split("/", 3)[3] if "?" in server.address else "")
        self.socket = WebSocket("127.0.0.1", server.port, path,
                                origin=f"http://127.0.0.1:{server.port}", timeout=300)
        self.number, self.header, self.client, self.scene, self.cost = 0, None, 0, None, None
        self.send(type="hello", protocol=1)

    def send(self, **message):
        self.number += 1
        self.socket.send(json.dumps({**message, "n": self.number}))
        return self.number

    def step(self):
        kind, data = self.socket.receive()
        if kind == TEXT:
            message = json.loads(data)
            if message["type"] == "welcome":
                self.client = message["client"]
            elif message["type"] == "scene":
                self.scene = message
            elif message["type"] == "edits":
                self.cost = message["cost"]
            elif message["type"] in ("error", "failed"):
                raise RuntimeError(message["message"])
            return
        size = struct.unpack("<I", data[:4])[0]
        self.header = json.loads(data[4:4 + size])
        self.send(type="shows", picture=self.header["picture"])

    def ready(self):
        return bool(self.socket.buffer) or bool(select.select([self.socket.socket], [], [], 0)[0])

    def wait(self, wanted):
        while not wanted():
            self.step()

    def rest(self, seconds):
        """Takes what comes for a time."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if self.ready():
                self.step()
            else:
                time.sleep(0.002)

    def handled(self, edits):
        return self.header["handled"].get(str(self.client), [0, 0])[1 if edits else 0]

    def answer(self, edits, **message):
        """Milliseconds from this message to the first picture that shows it."""
        start = time.monotonic()
        number = self.send(**message)
        self.wait(lambda: self.handled(edits) >= number)
        return 1000 * (time.monotonic() - start)


def processor_seconds(pid):
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def peak_mb(pid):
    for line in pathlib.Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith("VmHWM"):
            return int(line.split()[1]) / 1024
    return math.nan


def row(name, times, note=""):
    times = sorted(times)
    p95 = times[min(len(times) - 1, math.ceil(0.95 * len(times)) - 1)]
    print(f"{name:32} n {len(times):3}  median {statistics.median(times):7.0f} ms  "
          f"p95 {p95:7.0f} ms  {note}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build")
    parser.add_argument("scene")
    parser.add_argument("--size", default="640x480")
    parser.add_argument("--moves", type=int, default=60)
    parser.add_argument("--edits", type=int, default=20)
    parser.add_argument("--object", default="lamp", help="part of the name of what is moved")
    parser.add_argument("--pages", type=int, default=20)
    parser.add_argument("--indirect", default="gather", help="as for lte_view")
    args = parser.parse_args()
    start = time.monotonic()
    server = ViewServer(pathlib.Path(args.build) / "bin/lte_view", args.scene, "--size", args.size,
                        "--indirect", args.indirect)
    pid = server.process.pid
    try:
        page = Client(server)
        page.wait(lambda: page.header is not None and page.scene is not None)
        print(f"first picture {time.monotonic() - start:.2f} s after the start, "
              f"answered by {page.header['answered_by']}", flush=True)
        page.wait(lambda: page.header["pass"] >= 2)
        print(f"whole picture {time.monotonic() - start:.2f} s after the start: "
              f"{json.dumps(page.header['ms'])}", flush=True)
        choose = random.Random(1)
        camera = page.header["camera"]

        def move():
            turn = choose.uniform(-0.3, 0.3)
            c, s = math.cos(turn), math.sin(turn)
            x, y, z = (t - o for t, o in zip(camera["target"], camera["origin"]))
            view = (x * c + z * s, y, -x * s + z * c)
            target = [o + v for o, v in zip(camera["origin"], view)]
            return page.answer(False, type="camera", origin=camera["origin"], target=target,
                               up=camera["up"], vfov=camera["vfov"])

        def moves(count):
            times, headers = [], []
            for _ in range(count):
                page.rest(choose.uniform(0.1, 0.6))
                times.append(move())
                headers.append(page.header)
            return times, headers

        moves(3)
        before = processor_seconds(pid)
        times, headers = moves(args.moves)
        row("camera", times, f"drafts {statistics.median(h['width'] for h in headers):.0f} wide "
            f"in {statistics.median(h['elapsed'] for h in headers):.0f} ms, "
            f"{(processor_seconds(pid) - before) / args.moves:.2f} cpu s a move, refining included")
        print("    the last draft:", json.dumps(headers[-1]["ms"]))

        def dim(light):
            gain = round(choose.uniform(0.1, 2), 3)
            return page.answer(True, type="light", light=light, gain=gain, color=[1, 1, 1],
                               gesture=0)

        page.rest(1)
        lights = [light["light"] for light in page.scene["lights"]]
        first = [dim(light) for light in lights]
        row("dim, the first time of a light", first)
        times = []
        for i in range(args.edits):
            page.rest(choose.uniform(0.2, 0.8))
            times.append(dim(lights[i % len(lights)]))
        row("dim, again", times, f"last: {page.cost['total']:.0f} ms of edit, "
            f"{page.cost['encodings']} encodings")
        times, headers = moves(args.moves)
        row("camera, all lights apart", times,
            f"drafts {statistics.median(h['width'] for h in headers):.0f} wide "
            f"in {statistics.median(h['elapsed'] for h in headers):.0f} ms")
        number = next(o["object"] for o in page.scene["objects"] if args.object in o["name"])
        name = next(o["name"] for o in page.scene["objects"] if o["object"] == number)
        times, lit = [], []
        for _ in range(max(1, args.edits // 2)):
            page.rest(choose.uniform(0.2, 0.8))
            shift = [round(choose.uniform(-0.3, 0.3), 3), 0, round(choose.uniform(-0.3, 0.3), 3)]
            start = time.monotonic()
            times.append(page.answer(True, type="object", object=number, move=shift, turn=0,
                                     scale=1, gesture=0))
            page.wait(lambda: page.header["light"] != "kept")
            lit.append(1000 * (time.monotonic() - start))
            costs = json.dumps(page.cost)
        row(f"move {name}: with direct light", times)
        row("    with new indirect light", lit, f"last: {costs}")
        start = time.monotonic()
        page.wait(lambda: page.header["light"] == "full")
        print(f"    with all of it {1000 * (time.monotonic() - start):.0f} ms later:",
              json.dumps(page.cost))
        page.send(type="reset")
        page.rest(2)
        before = processor_seconds(pid)
        alone, _ = moves(args.moves // 2)
        cost = (processor_seconds(pid) - before) / len(alone)
        others = [Client(server) for _ in range(args.pages - 1)]
        before = processor_seconds(pid)
        for _ in range(args.moves // 2):
            page.rest(choose.uniform(0.1, 0.6))
            move()
            for other in others:
                while other.ready():
                    other.step()
        together = (processor_seconds(pid) - before) / (args.moves // 2)
        print(f"{args.pages} pages: {together:.2f} cpu s a move, {cost:.2f} for one page")
        print(f"peak memory {peak_mb(pid):.0f} MiB")
    finally:
        server.stop()


if __name__ == "__main__":
    main()
