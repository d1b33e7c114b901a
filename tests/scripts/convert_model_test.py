#!/usr/bin/env python3
"""scripts/convert_model.py: model files of format version 1 become version 2."""
import json
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
LTE = """channels: 48
stem: conv3
attention_positions: rotary
centering: learned
grid_per_spacing: 1.6
dropout: 0
gamma_hidden: 64
pair_geometry: normals
query_attention: sum
light_input: radiosity
light_sides: apart
light_variance: false
gloss: false
radiance_lobes: 0
radiance_head: directions
radiance_base: irradiance
target: indirect
scale: 16
"""


def model_file(model, config, version="1"):
    header = {"__metadata__": {"format": "lte-model", "format_version": version,
                               "model_config": model, "config": config, "suns": "true"},
              "a": {"dtype": "F32", "shape": [3], "data_offsets": [0, 12]},
              "b": {"dtype": "F32", "shape": [2], "data_offsets": [12, 20]}}
    text = json.dumps(header).encode()
    return struct.pack("<Q", len(text)) + text + bytes(range(20))


def parts(data):
    size = struct.unpack("<Q", data[:8])[0]
    return json.loads(data[8:8 + size]), data[8 + size:]


class Convert(unittest.TestCase):
    def run_on(self, data, name="old.safetensors"):
        with tempfile.TemporaryDirectory() as folder:
            old, new = pathlib.Path(folder) / name, pathlib.Path(folder) / "new.safetensors"
            old.write_bytes(data)
            run = subprocess.run([sys.executable, ROOT / "scripts/convert_model.py", old, new],
                                 capture_output=True, text=True, check=False)
            return run, new.read_bytes() if new.exists() else None

    def test_the_header_changes_and_the_weights_stay(self):
        config = ("seed: 2\naugment:\n  rotate: true\n  thinning: 2.5\nmodel:\n  channels: 48\n" +
                  "".join(f"  {line}\n" for line in LTE.splitlines()[1:-1]) +
                  "train:\n  beta1: 0.9\n  steps: 3\n")
        run, new = self.run_on(model_file(LTE, config))
        self.assertEqual(run.returncode, 0, run.stderr)
        header, data = parts(new)
        self.assertEqual(data, bytes(range(20)))
        metadata = header["__metadata__"]
        self.assertEqual(metadata["format_version"], "2")
        self.assertEqual(metadata["suns"], "true")
        self.assertEqual(metadata["model_config"],
                         "preset: lte\nchannels: 48\ndropout: 0\nlight_input: radiosity\n"
                         "radiance_lobes: 0\nscale: 16\n")
        self.assertEqual(metadata["config"],
                         "seed: 2\naugment:\n  rotate: vertical\n  point_dropout: 2.5\nmodel:\n"
                         "  preset: lte\n  channels: 48\n  dropout: 0\n  light_input: radiosity\n"
                         "  radiance_lobes: 0\ntrain:\n  steps: 3\n")

    def test_old_files_of_the_papers_form_name_no_form_at_all(self):
        run, new = self.run_on(model_file("channels: 32\nstem: conv5\nscale: 16\n", ""))
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(parts(new)[0]["__metadata__"]["model_config"],
                         "preset: paper\nchannels: 32\nscale: 16\n")

    def test_other_forms_are_refused_in_one_line_and_leave_nothing(self):
        for old, words in (("query_attention: sum", "query_attention: softmax"),
                           ("stem: conv3", "stem: linear"), ("target: indirect", "target: total"),
                           ("light_sides: apart", "light_sides: sum"),
                           ("gloss: false", "gloss: true")):
            run, new = self.run_on(model_file(LTE.replace(old, words), ""))
            self.assertEqual(run.returncode, 1, words)
            self.assertEqual(run.stderr.count("\n"), 1, run.stderr)
            self.assertIn("old.safetensors", run.stderr)
            self.assertIsNone(new)
        run, _ = self.run_on(model_file(LTE, "", version="2"))
        self.assertIn("not a model file of format version 1", run.stderr)


if __name__ == "__main__":
    unittest.main()
