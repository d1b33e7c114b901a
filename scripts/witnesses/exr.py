"""Reads the EXR pictures that lte writes, by Python's standard library alone."""
import array
import itertools
import pathlib
import struct
import zlib

TYPES = {0: ("I", 4), 1: ("e", 2), 2: ("f", 4)}  # letter for struct, bytes
LINES = {0: 1, 2: 1, 3: 16}  # of a block, by compression: none, ZIPS, ZIP
ALPHABET = "RGBAXYZ"


def attributes(raw):
    """Name to bytes, and where the table of offsets begins."""
    at, out = 8, {}

    def text():
        nonlocal at
        end = raw.index(b"\0", at)
        word, at = raw[at:end].decode(), end + 1
        return word

    while name := text():
        text()  # its type
        size, = struct.unpack_from("<i", raw, at)
        out[name] = raw[at + 4:at + 4 + size]
        at += 4 + size
    return out, at


def channels_of(blob):
    """(name, letter, bytes) of each channel, in the order of the file."""
    at = 0
    while blob[at]:
        end = blob.index(b"\0", at)
        kind, _, x, y = struct.unpack_from("<iIii", blob, end + 1)
        if (x, y) != (1, 1):
            raise ValueError("a channel is subsampled")
        yield blob[at:end].decode(), *TYPES[kind]
        at = end + 17


def unpacked(block, size):
    if len(block) == size:
        return block
    # Differences of bytes, of which the even places come first and then the odd ones.
    data = bytes(itertools.accumulate(zlib.decompress(block), lambda a, b: (a + b - 128) & 255))
    out = bytearray(size)
    out[0::2], out[1::2] = data[:(size + 1) // 2], data[(size + 1) // 2:]
    return bytes(out)


def read_exr(path):
    """Width, height, and for each layer ("" is the picture) a list of rows-first tuples of its
    channels, in the order R G B A X Y Z. Only what lte writes: scan lines, ZIP or none."""
    raw = pathlib.Path(path).read_bytes()
    if raw[:4] != b"\x76\x2f\x31\x01":
        raise ValueError(f"{path}: no EXR")
    header, at = attributes(raw)
    x0, y0, x1, y1 = struct.unpack("<4i", header["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    compression, channels = header["compression"][0], list(channels_of(header["channels"]))
    if compression not in LINES:
        raise ValueError(f"{path}: compression {compression} is not read here")
    lines = LINES[compression]
    planes = {name: array.array("f") for name, _, _ in channels}
    row = width * sum(size for _, _, size in channels)
    for offset in struct.unpack_from(f"<{-(-height // lines)}Q", raw, at):
        y, size = struct.unpack_from("<ii", raw, offset)
        count = min(lines, y1 + 1 - y)
        block, place = unpacked(raw[offset + 8:offset + 8 + size], count * row), 0
        for _ in range(count):
            for name, letter, wide in channels:
                planes[name].extend(struct.unpack_from(f"<{width}{letter}", block, place))
                place += width * wide
    layers = {}
    for name in planes:
        layers.setdefault(name.rpartition(".")[0], []).append(name)
    order = lambda name: ALPHABET.find(name[-1])
    return width, height, {
        layer: list(zip(*(planes[name] for name in sorted(names, key=order))))
        for layer, names in layers.items()
    }
