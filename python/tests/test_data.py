"""Generated scenes and data sets."""
import json
import struct
import subprocess
import sys

import numpy as np
import pytest

import lte

TINY = ("scenes: 1\nseed: 5\ngenerator: boxes\nscene_points: 256\nquery_points: 64\nrays: 16\n"
        "evaluation_splits: []\n")


def read_safetensors(path):
    """Names and arrays of the file, whose format is public."""
    data = path.read_bytes()
    (length,) = struct.unpack_from("<Q", data)
    header = json.loads(data[8:8 + length])
    kinds = {"F32": np.float32, "I32": np.int32, "U8": np.uint8, "F16": np.float16}
    return {name: np.frombuffer(data[8 + length:][slice(*about["data_offsets"])],
                                kinds[about["dtype"]]).reshape(about["shape"])
            for name, about in header.items() if name != "__metadata__"}


def test_a_data_set_is_that_of_lte_datagen(tmp_path, tool):
    (tmp_path / "tiny.yaml").write_text(TINY)
    counts = lte.generate_dataset(tmp_path / "tiny.yaml", tmp_path / "python")
    assert counts == {"baked": 1, "kept": 0, "planned": 1}
    tool("lte_datagen", "generate", "--config", tmp_path / "tiny.yaml", "--out", tmp_path / "tool")
    scenes = [list((tmp_path / who / "scenes").iterdir()) for who in ("python", "tool")]
    assert [p.name for p in scenes[0]] == [p.name for p in scenes[1]] and scenes[0]
    assert scenes[0][0].read_bytes() == scenes[1][0].read_bytes()


def test_a_sample_is_what_its_file_says(tmp_path):
    (tmp_path / "tiny.yaml").write_text(TINY)
    lte.generate_dataset(tmp_path / "tiny.yaml", tmp_path / "set")
    (file,) = (tmp_path / "set/scenes").glob("*.safetensors")
    found, expected = lte.read_sample(file), read_safetensors(file)
    assert set(found) == set(expected)
    for name, values in expected.items():
        assert found[name].dtype == values.dtype and found[name].shape == values.shape
        assert found[name].tobytes() == values.tobytes(), name
    damaged = bytearray(file.read_bytes())
    damaged[-5] ^= 1
    file.write_bytes(damaged)
    with pytest.raises(lte.Error, match=file.name):
        lte.read_sample(file)
    with pytest.raises(lte.Error, match="none.safetensors"):
        lte.read_sample(tmp_path / "none.safetensors")


def test_a_data_set_goes_on(tmp_path):
    (tmp_path / "tiny.yaml").write_text(TINY)
    config, out = tmp_path / "tiny.yaml", tmp_path / "set"
    lte.generate_dataset(config, out, set={"query_points": 32})
    (file,) = (out / "scenes").glob("*.safetensors")
    tensors = read_safetensors(file)
    assert tensors["query_position"].shape == (32, 3)
    assert np.isfinite(tensors["query_position"]).all()
    with pytest.raises(lte.Error, match="set"):
        lte.generate_dataset(config, out, set={"query_points": 32})
    again = lte.generate_dataset(config, out, set={"query_points": 32}, resume=True)
    assert again == {"baked": 0, "kept": 1, "planned": 1}
    with pytest.raises(lte.Error, match="query_pints"):
        lte.generate_dataset(config, tmp_path / "other", set={"query_pints": 32})
    assert not (tmp_path / "other").exists()


@pytest.mark.parametrize("generator", ["boxes", "wild"])
def test_generated_scenes_can_be_saved_and_read(tmp_path, generator):
    home = lte.generate_scene(generator, seed=4)
    home.save(tmp_path / "home.glb")
    again = lte.load(tmp_path / "home.glb")
    assert again.triangles == home.triangles
    points = home.sample(10)
    np.testing.assert_allclose(again.sample(10)[0], points[0], atol=1e-5)


SMALL = lte.configs / "data" / "homes_small.yaml"


def test_homes_are_those_of_lte_datagen(tmp_path, tool):
    """Of all splits: some have views, as their files do."""
    (tmp_path / "homes.yaml").write_text(
        f"parent: {SMALL}\nval_share: 0.5\ntest_share: 0\nevaluation_splits: [val]\nscenes: 3\n"
        "seed: 99\nscene_points: 512\nviews: {count: 1, rays: 16, width: 24, height: 16}\n")
    tool("lte_datagen", "generate", "--config", tmp_path / "homes.yaml", "--out", tmp_path / "set",
         "--set", "seed=7", "--set", "query_points=64", "--set", "rays=16")
    files = sorted((tmp_path / "set" / "scenes").glob("*.safetensors"))
    homes = list(lte.homes(seed=7, count=3, config=tmp_path / "homes.yaml"))
    assert [home.name for home in homes] == [file.stem for file in files] and len(files) == 3
    views = 0
    for home, file in zip(homes, files):
        found, expected = home.bake(queries=64, rays=16), read_safetensors(file)
        assert set(found) == set(expected) == set(lte.read_sample(file))
        views += "view0_mask" in found
        for name, values in expected.items():
            assert found[name].dtype == values.dtype and found[name].shape == values.shape
            assert found[name].tobytes() == values.tobytes(), name
    assert 0 < views < 3


def test_a_dimmed_home_has_less_light():
    keys = {"scene_points": 256, "views.count": 0}
    (home,) = lte.homes(seed=7, config=SMALL)
    bright = home.bake(queries=64, rays=64, set=keys)
    for lamp in home.lights:
        lamp.gain = 0.5
    dark = home.bake(queries=64, rays=64, set=keys)
    np.testing.assert_array_equal(dark["query_position"], bright["query_position"])
    np.testing.assert_allclose(dark["direct"], bright["direct"] / 2, rtol=1e-4, atol=1e-4)
    assert bright["direct"].sum() > 0 and len(home.lights) == len(bright["direct"])


def test_homes_come_one_after_the_other():
    homes = lte.homes(seed=3, count=1 << 30, config=SMALL)
    first, second = next(homes), next(homes)
    assert first.name == "home_00000" and second.name == "home_00001"
    assert first.triangles != second.triangles


@pytest.mark.parametrize("call, words", [
    (lambda: lte.homes(seed=-1), "seed: expected 0 to"),
    (lambda: lte.homes(count=1.5), "count: expected a whole number"),
    (lambda: next(lte.homes(config="no.yaml")), "no.yaml"),
    (lambda: next(lte.homes(config=SMALL)).bake(rays=0), "rays: expected 1 to"),
    (lambda: next(lte.homes(config=SMALL)).bake(set={"rayz": 8}), "rayz"),
    (lambda: lte.info("no.glb"), "no.glb")])
def test_wrong_homes_are_named(call, words):
    with pytest.raises((TypeError, ValueError, lte.Error)) as caught:
        call()
    assert words in str(caught.value) and "\n" not in str(caught.value)


def test_info_is_what_lte_info_prints(room_file, tmp_path):
    said = subprocess.run([sys.executable, "-m", "lte", "info"], text=True, check=True,
                          capture_output=True).stdout
    about = lte.info()
    assert {key: json.loads(value) for key, value in
            (line.split(": ", 1) for line in said.splitlines())} == about
    assert about["version"] == lte.__version__ and about["threads"] >= 1
    assert about["models"]["lte"].endswith("lte.safetensors") and about["denoiser"]
    assert ".glb" in about["scenes"] and "instruction_set" in about and "torch" in about
    subprocess.run([sys.executable, "-m", "lte", "info", room_file, "--json", tmp_path / "a.json"],
                   check=True, capture_output=True)
    assert lte.info(room_file) == json.loads((tmp_path / "a.json").read_text())
