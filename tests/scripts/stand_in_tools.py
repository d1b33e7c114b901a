"""Programs in the place of lte_datagen and lte_probe, and rooms that nobody reads, for tests of
scripts that ask for light at points."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

# Writes a sample file of the tensors that TENSORS names: values and shape by name.
DATAGEN = """#!{python}
import json, struct, sys
header, body = {header}, b""
for name, (values, shape) in {tensors}.items():
    data = struct.pack(f"<{{len(values)}}f", *values)
    header[name] = {{"dtype": "F32", "shape": shape,
                    "data_offsets": [len(body), len(body) + len(data)]}}
    body += data
text = json.dumps(header).encode()
with open(sys.argv[sys.argv.index("--out") + 1], "wb") as file:
    file.write(struct.pack("<Q", len(text)) + text + body)
"""
# Four points, as samples have them.
POINTS = {"query_position": (list(range(12)), [4, 3]), "query_normal": ([0, 1, 0] * 4, [4, 3])}


class ScriptTest(unittest.TestCase):
    """Of a script that takes scenes, --bin, --work and --points.

    Subclasses say SCRIPT, FLAGS, PROBE (the text of lte_probe, for str.format), TENSORS beside
    POINTS and HEADER of the sample, and INTERPRETER's flags.
    """

    FLAGS, TENSORS, HEADER, INTERPRETER = (), {}, {}, ()

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        datagen = DATAGEN.format(python=sys.executable, header=self.HEADER,
                                 tensors={**self.TENSORS, **POINTS})
        probe = self.PROBE.format(python=sys.executable)
        for name, text in (("lte_datagen", datagen), ("lte_probe", probe)):
            tool = self.folder / name
            tool.write_text(text)
            tool.chmod(0o755)
        (self.folder / "rooms").mkdir()
        for name in ("a.glb", "b.obj", "b.camera.json"):
            (self.folder / "rooms" / name).touch()

    def run_script(self, *more):
        return subprocess.run(
            [sys.executable, *self.INTERPRETER, self.SCRIPT, self.folder / "rooms", "--bin",
             self.folder, "--work", self.folder / "work", "--points", "4", *self.FLAGS, *more],
            capture_output=True, text=True, check=False)

    def run_with_a_failing_probe(self):
        (self.folder / "lte_probe").write_text(
            "#!/bin/sh\necho 'lte_probe: no light' >&2; exit 1\n")
        return self.run_script()
