"""Writes .exr files as lte_render does: 32-bit floats, blocks of 16 rows compressed by zlib."""
import array
import struct
import zlib


def text(words):
    return words.encode() + b"\0"


def attribute(name, kind, value):
    return text(name) + text(kind) + struct.pack("<i", len(value)) + value


def deflate(block):
    """As it is where it does not shrink."""
    halves = block[::2] + block[1::2]
    packed = zlib.compress(bytes([halves[0]]) + bytes(
        (b - a + 128) & 255 for a, b in zip(halves, halves[1:])))
    return packed if len(packed) < len(block) else block


def write_exr(path, width, height, channels, compression=3):
    """@param channels  by name the numbers, row by row"""
    names = sorted(channels)
    listed = b"".join(text(name) + struct.pack("<iiii", 2, 0, 1, 1) for name in names) + b"\0"
    window = struct.pack("<iiii", 0, 0, width - 1, height - 1)
    out = struct.pack("<ii", 20000630, 2) + attribute("channels", "chlist", listed) \
        + attribute("compression", "compression", bytes([compression])) \
        + attribute("dataWindow", "box2i", window) + b"\0"
    chunks = []
    for top in range(0, height, 16):
        rows = [channels[name][y * width:(y + 1) * width]
                for y in range(top, min(top + 16, height)) for name in names]
        packed = deflate(b"".join(array.array("f", row).tobytes() for row in rows))
        chunks.append(struct.pack("<ii", top, len(packed)) + packed)
    begin = len(out) + 8 * len(chunks)
    for chunk in chunks:
        out += struct.pack("<q", begin)
        begin += len(chunk)
    path.write_bytes(out + b"".join(chunks))
