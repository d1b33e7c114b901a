"""Generated scenes and data sets."""
import json
import struct

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
