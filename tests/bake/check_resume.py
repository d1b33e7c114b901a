#!/usr/bin/env python3
"""lte_bake killed at many moments, in shards, and on a disk that is full.

usage: tests/bake/check_resume.py LTE_BAKE SCENE [KILLS]

Whatever happens, --resume ends with the bytes of a bake that nothing has stopped, but for the
seconds in lightmap.json; and what goes wrong leaves an earlier bake as it was, and one line.
"""
import json
import pathlib
import resource
import subprocess
import sys
import tempfile
import time


def main():
    tool, scene = sys.argv[1:3]
    kills = int(sys.argv[3]) if len(sys.argv) > 3 else 20
    common = [tool, scene, "--texels-per-metre", "32", "--quality", "final", "--threads", "1",
              "--quiet", "--set", "keep_every=0"]

    def bake(out, *flags, **options):
        return subprocess.run([*common, "--out", str(out), *flags], capture_output=True, text=True,
                              timeout=300, **options)

    def content(folder):
        out = {}
        for path in sorted(folder.iterdir()):
            out[path.name] = path.read_bytes()
            if path.name == "lightmap.json":
                record = json.loads(out[path.name])
                record.pop("seconds")
                out[path.name] = record
        return out

    def expect(condition, what):
        if not condition:
            sys.exit(f"check_resume: {what}")

    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        start = time.monotonic()
        whole = bake(folder / "whole")
        seconds = time.monotonic() - start
        expect(whole.returncode == 0, whole.stderr)
        wanted = content(folder / "whole")
        expect(not any(file.startswith("part_") for file in wanted), "a part was left behind")

        found = 0
        for k in range(kills):
            out = folder / f"killed_{k}"
            run = subprocess.Popen([*common, "--out", str(out)], stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL)
            time.sleep(seconds * (0.2 + 0.8 * (k + 0.5) / kills))
            run.kill()
            run.wait()
            found += any(out.glob("part_*.safetensors")) if out.exists() else 0
            resumed = bake(out, "--resume")
            expect(resumed.returncode == 0, resumed.stderr)
            # What a killed writer leaves under a name of its own is nobody's.
            got = {file: data for file, data in content(out).items() if file in wanted
                   or file.startswith("part_")}
            expect(got == wanted, f"other bytes after a kill at {k}/{kills} of {seconds:.1f} s")
        expect(found > 0, "no kill found a part to go on with")

        shared = folder / "shards"
        for k in (2, 3, 1):
            one = bake(shared, "--shard", f"{k}/3")
            expect(one.returncode == 0, one.stderr)
            expect(not (shared / "lightmap.exr").exists(), "a shard wrote a light map")
        joined = bake(shared, "--resume")
        expect(joined.returncode == 0 and content(shared) == wanted, "shards join to other bytes")

        bake(folder / "other", "--shard", "1/2", "--seed", "9")
        other = bake(folder / "other", "--resume")
        expect(other.returncode == 1 and "--seed" in other.stderr
               and len(other.stderr.splitlines()) == 1, f"a mixture was made: {other.stderr}")

        def small_files():
            resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))

        full = bake(folder / "whole", preexec_fn=small_files)
        lines = [line for line in full.stderr.splitlines() if "warning" not in line]
        expect(full.returncode == 1 and len(lines) == 1, f"a full disk: {full.stderr}")
        expect(content(folder / "whole") == wanted, "a full disk cost an earlier bake")
        nowhere = bake(folder / "whole" / "scene.glb" / "sub")
        expect(nowhere.returncode == 1 and len(nowhere.stderr.splitlines()) == 1,
               f"an unwritable place: {nowhere.stderr}")
        print(f"check_resume: {kills} kills, {found} with a part; shards and full disks hold")


main()
