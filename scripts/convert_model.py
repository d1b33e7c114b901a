#!/usr/bin/env python3
"""Makes a model file of format version 2 from one of version 1. Weights stay as they are.

  scripts/convert_model.py OLD.safetensors NEW.safetensors
  scripts/convert_model.py OLD.yaml NEW.yaml        the training configuration beside it

Version 2 has one key, `preset`, for the form of the network. A model of neither form, "paper" or
"lte", is refused: lte 0.1 reads it. It needs Python's standard library alone.
"""
import json
import pathlib
import re
import struct
import sys

# The keys that the preset decides, with the values of both presets.
FORM = {"stem": ("conv5", "conv3"), "attention_positions": ("none", "rotary"),
        "centering": ("none", "learned"), "grid_per_spacing": ("0.8", "1.6"),
        "pair_geometry": ("offset", "normals")}
# Keys that are gone, with the only value that is left of each.
FIXED = {"query_attention": "sum", "target": "indirect", "gamma_hidden": "64", "ffn_ratio": "4",
         "radiance_head": "directions", "query_sampling": "uniform", "single_light": "0.0",
         "subsample": "true", "noise_weight": "0.0", "beta1": "0.9", "beta2": "0.999",
         "muon_momentum": "0.95", "preview_scenes": "4", "tensorboard": "true"}
RENAMED = {"thinning": "point_dropout", "permute_colours": "permute_colors"}
CHECKSUM = '"lte_checksum":"'
MASK, GOLDEN = (1 << 64) - 1, 0x9E3779B97F4A7C15


class Unfit(Exception):
    pass


def one_of(value, wanted):
    try:
        return float(value) == float(wanted)
    except ValueError:
        return value == wanted


def preset_of(model):
    for column, preset in enumerate(("paper", "lte")):
        if all(one_of(model.get(key, values[0]), values[column]) for key, values in FORM.items()):
            break
    else:
        raise Unfit("a form between the presets: " +
                    ", ".join(f"{key} {model[key]}" for key in FORM if key in model))
    light = model.get("light_input", "emission")
    sides, variance = model.get("light_sides", "sum"), model.get("light_variance", "false")
    if light == "direct" or (light != "emission" and sides != "apart") or (
            (variance == "true") != (light == "traced")):
        raise Unfit(f"light_input {light} with light_sides {sides}, light_variance {variance}")
    radiance = float(model.get("radiance_lobes", "0")) > 0
    if (model.get("gloss", "false") == "true") != radiance or (
            radiance and model.get("radiance_base") != "points"):
        raise Unfit("a radiance decoder that reads no gloss or casts no rays")
    return preset


def converted(yaml):
    """Training or model configuration: a key a line, sections indented by two."""
    pairs = [re.fullmatch(r"( *)(\w+): *(.*?)( +#.*)?", line) for line in yaml.splitlines()]
    model = {pair[2]: pair[3] for pair in pairs if pair}
    preset, lines = None, []
    for line, pair in zip(yaml.splitlines(), pairs):
        key, value = (pair[2], pair[3]) if pair else ("", "")
        if key == "channels":
            preset = preset_of(model)
            lines.append(f"{pair[1]}preset: {preset}")
        if key in FIXED and not one_of(value, FIXED[key]):
            raise Unfit(f"{key}: {value}")
        if key in FORM or key in FIXED or key in ("light_sides", "light_variance", "gloss",
                                                  "radiance_base"):
            continue
        if key == "rotate" and value == "true":
            line = line.replace("true", "vertical")
        lines.append(line.replace(key, RENAMED[key], 1) if key in RENAMED else line)
    return "\n".join(lines) + "\n"


def mix_bits(z):
    z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & MASK
    z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & MASK
    return z ^ (z >> 31)


def combine(a, b):
    """hash_combine() of lte/base/random.h."""
    mixed = mix_bits((b + GOLDEN) & MASK)
    return mix_bits((a ^ (mixed + GOLDEN + (a << 6) + (a >> 2))) & MASK)


def checksum(parts):
    """Checksum of lte/base/checksum.h."""
    lanes = [1, 2, 3, 4]
    for part in parts:
        padded = part + bytes(-len(part) % 32)
        for lane in range(4):
            hash_ = lanes[lane]
            for (word,) in struct.iter_unpack("<Q24x", padded[8 * lane:] + bytes(8 * lane)):
                hash_ = ((hash_ ^ word) * GOLDEN) & MASK
                hash_ = ((hash_ << 31) | (hash_ >> 33)) & MASK
            lanes[lane] = hash_
        lanes[0] = combine(lanes[0], len(part))
    hash_ = 0
    for lane in lanes:
        hash_ = combine(hash_, lane)
    return hash_


def convert(old):
    size = struct.unpack("<Q", old[:8])[0]
    header, data = json.loads(old[8:8 + size]), old[8 + size:]
    metadata = header["__metadata__"]
    if metadata.get("format") != "lte-model" or metadata.get("format_version") != "1":
        raise Unfit("not a model file of format version 1")
    metadata["format_version"] = "2"
    metadata["lte_checksum"] = "0" * 16
    for key in ("model_config", "config"):
        if key in metadata:
            metadata[key] = converted(metadata[key])
    text = json.dumps(header, separators=(",", ":"), sort_keys=True, ensure_ascii=False).encode()
    text += b" " * (-(8 + len(text)) % 64)
    tensors = sorted((t["data_offsets"] for name, t in header.items() if name != "__metadata__"))
    sum_ = checksum([struct.pack("<Q", len(text)), text] + [data[a:b] for a, b in tensors])
    at = text.index(CHECKSUM.encode()) + len(CHECKSUM)
    return struct.pack("<Q", len(text)) + text[:at] + b"%016x" % sum_ + text[at + 16:] + data


def main():
    if len(sys.argv) != 3:
        print(__doc__.strip(), file=sys.stderr)
        return 2
    old, new = map(pathlib.Path, sys.argv[1:])
    try:
        out = (converted(old.read_text()).encode() if old.suffix == ".yaml"
               else convert(old.read_bytes()))
        new.write_bytes(out)
    except (OSError, KeyError, ValueError, struct.error, Unfit) as error:
        print(f"convert_model.py: {old}: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
