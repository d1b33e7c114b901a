"""Reads a layer of the .exr files that lte_render writes: 32-bit floats in blocks of 16 rows, each
compressed by zlib."""
import array
import itertools
import struct
import zlib

MAGIC, VERSION, ZIP, FLOAT, ROWS = 20000630, 2, 3, 2, 16


class Reader:
    """Takes numbers and names from the begin of bytes on."""

    def __init__(self, data):
        self.data, self.place = data, 0

    def number(self, form):
        value, = struct.unpack_from(f"<{form}", self.data, self.place)
        self.place += struct.calcsize(f"<{form}")
        return value

    def name(self):
        end = self.data.index(b"\0", self.place)
        text = self.data[self.place:end].decode()
        self.place = end + 1
        return text

    def bytes(self, count):
        self.place += count
        return self.data[self.place - count:self.place]


def read_header(file):
    """Attributes by name."""
    if (file.number("i"), file.number("i")) != (MAGIC, VERSION):
        raise ValueError("is no .exr file of one picture in rows")
    out = {}
    while name := file.name():
        file.name()  # of the type, which follows from the attribute's own
        out[name] = file.bytes(file.number("i"))
    return out


def read_channels(text):
    """Names, in the order of the file."""
    file, out = Reader(text), []
    while name := file.name():
        kind, *_ = struct.unpack("<iiii", file.bytes(16))
        if kind != FLOAT:
            raise ValueError(f"channel {name} has no 32-bit floats")
        out.append(name)
    return out


def inflate(packed, size):
    """A block of so many bytes; one that would not have shrunk is in the file as it is."""
    if len(packed) == size:
        return packed
    # Each byte is told by its difference from the one before, and those at even places come first.
    differences = itertools.chain(zlib.decompress(packed))
    halves = bytes(itertools.accumulate(differences, lambda before, d: (before + d - 128) & 255))
    out = bytearray(size)
    out[::2], out[1::2] = halves[:(size + 1) // 2], halves[(size + 1) // 2:]
    return bytes(out)


def read_layer(path, *names):
    """Width, height and, of each channel such as indirect.R, its numbers row by row.

    @throws ValueError where the file is another kind of .exr or lacks a channel
    """
    try:
        file = Reader(path.read_bytes())
        header = read_header(file)
        left, top, right, bottom = struct.unpack("<iiii", header["dataWindow"])
        width, height = right - left + 1, bottom - top + 1
        channels = read_channels(header["channels"])
        if header["compression"] != bytes([ZIP]):
            raise ValueError("is not compressed by blocks of zlib")
        missing = [name for name in names if name not in channels]
        if missing:
            raise ValueError(f"has no channel {missing[0]}")
        blocks = -(-height // ROWS)
        file.place += 8 * blocks  # where they begin
        out = {name: array.array("f") for name in names}
        for block in range(blocks):
            file.number("i")
            rows = min(ROWS, height - block * ROWS)
            values = array.array("f", inflate(file.bytes(file.number("i")),
                                              4 * rows * width * len(channels)))
            for row, (k, name) in itertools.product(range(rows), enumerate(channels)):
                if name in out:
                    begin = (row * len(channels) + k) * width
                    out[name].extend(values[begin:begin + width])
        return width, height, [out[name] for name in names]
    except (ValueError, struct.error, zlib.error) as error:
        raise ValueError(f"{path}: {error}") from error
