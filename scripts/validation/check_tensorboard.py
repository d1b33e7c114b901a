#!/usr/bin/env python3
"""Reads the event files of a run back with TensorBoard itself: a run that is stopped, goes on,
crashes past its checkpoint in the middle of a record and is resumed must show every step once, with
the values of log.jsonl, and its previews.

usage: scripts/validation/check_tensorboard.py [BUILD]

It needs PyPI's tensorboard; without it the exit code is 77, skipped.
"""
import json
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile

SKIPPED = 77
STEPS = 12
MODEL = {
    "model.channels": 32,
    "model.nne_neighbours": 8,
    "model.patch_size": 64,
    "model.query_layers": 2,
    "model.encoder_depths": [1, 1],
    "model.encoder_widths": [1, 1],
    "model.decoder_depths": [1],
    "model.decoder_widths": [1],
    "data.scene_points": 256,
    "data.queries_per_scene": 128,
    "train.steps": STEPS,
    "train.log_every": 1,
    "train.warmup_steps": 2,
    "train.validate_every": 4,
    "train.checkpoint_every": 4,
    "train.preview_every": 4,
}


def run(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(
            f"{' '.join(map(str, command))}: exit code {done.returncode}: {done.stderr.strip()}")


def settings(values):
    return [
        word for key, value in values.items() for word in ("--set", f"{key}={json.dumps(value)}")
    ]


def make_data(tools, folder):
    run(
        tools / "lte_datagen", "generate", "--config", "configs/data/boxes_small.yaml", "--out",
        folder, "--scenes", 4, "--quiet",
        *settings({
            "val_share": 0.5, "test_share": 0, "scene_points": 256, "query_points": 128, "rays": 16,
            "views.count": 1, "views.width": 16, "views.height": 12, "views.rays": 16
        }))


def crash(run_folder, checkpoint):
    """What a power cut leaves: an older checkpoint, later steps in the log and the events, the last
    record cut short."""
    shutil.copy(checkpoint, run_folder / "checkpoint.safetensors")
    newest = sorted((run_folder / "tensorboard").iterdir())[-1]
    newest.write_bytes(newest.read_bytes()[:-5])


def main():
    try:
        from tensorboard.backend.event_processing.event_accumulator import EventAccumulator
        from tensorboard.util import tensor_util
    except ImportError as error:
        print(f"skipped: {error}; PyPI's tensorboard is needed")
        return SKIPPED
    tools = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "build") / "bin"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        make_data(tools, folder / "data")
        out = folder / "run"
        train = [
            tools / "lte_train", "--config", "configs/base.yaml", "--out", out, "--quiet",
            *settings(MODEL | {"data.root": str(folder / "data")})
        ]
        run(*train, "--stop-after", 4)
        shutil.copy(out / "checkpoint.safetensors", folder / "at4.safetensors")
        run(*train, "--resume", "--stop-after", 3)
        crash(out, folder / "at4.safetensors")
        run(*train, "--resume")
        run(*train, "--resume")  # nothing left to do, and nothing must be added
        lines = [json.loads(line) for line in (out / "log.jsonl").read_text().splitlines()]
        files = sorted((out / "tensorboard").iterdir())
        accumulator = EventAccumulator(str(out / "tensorboard"),
                                       size_guidance={"tensors": 0, "images": 0, "scalars": 0})
        accumulator.Reload()
    tags = accumulator.Tags()
    pictures = [tag for tag in tags["tensors"] + tags["images"] if tag.startswith("preview/")]
    tag_of = {
        "loss": "train/loss", "lr": "train/lr", "grad_norm": "train/grad_norm",
        "grad_norm_encoder_down0": "grad_norm/encoder_down0", "val_loss": "val/loss",
        "val_psnr": "val/psnr"
    }
    for field, tag in tag_of.items():
        logged = [(line["step"], line[field]) for line in lines if field in line]
        if tag in tags["scalars"]:
            shown = [(event.step, event.value) for event in accumulator.Scalars(tag)]
        else:  # newer versions keep scalars as tensors
            shown = [(event.step, float(tensor_util.make_ndarray(event.tensor_proto)))
                     for event in accumulator.Tensors(tag)]
        rounded = [(step, struct.unpack("f", struct.pack("f", value))[0]) for step, value in logged]
        assert shown == rounded, f"{tag}: TensorBoard shows {shown}, the log says {rounded}"
    steps = [line["step"] for line in lines if "loss" in line]
    assert steps == list(range(1, STEPS + 1)), steps
    assert pictures, f"no previews among {tags}"
    for tag in pictures:
        events = accumulator.Images(tag) if tag in tags["images"] else accumulator.Tensors(tag)
        assert [event.step for event in events] == [4, 8, 12], [event.step for event in events]
    print(
        f"{len(files)} event files, {len(steps)} steps, {len(pictures)} previewed scenes: as logged"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
