#!/usr/bin/env python3
"""Reads NAME.ktx2 of a folder by PyPI's pyktx2 and holds each to NAME.txt: a line of format, width,
height, depth and layers, then a line a texel.

usage: check_ktx2.py FOLDER
"""
import pathlib
import struct
import sys

from pyktx2 import parser

# pyktx2 0.3.1 knows the color models of compressed textures alone, the size of one format, and
# counts the padding of keys from multiples of 8 where the specification has 4.
RGBSDA = 1
parser.ColorModel = int
parser.get_stride = {parser.VkFormat.VK_FORMAT_R16G16B16A16_SFLOAT: 8,
                     parser.VkFormat.VK_FORMAT_E5B9G9R9_UFLOAT_PACK32: 4}.__getitem__
parser.BytesReader.get_padding_size = lambda self, alignment: -self.pos % alignment


def texels(data, vk_format):
    if vk_format == 97:
        for red, green, blue, alpha in struct.iter_unpack("<4e", data):
            assert alpha == 1, alpha
            yield red, green, blue
        return
    for (word, ) in struct.iter_unpack("<I", data):
        scale = 2.0**((word >> 27) - 24)
        yield tuple((word >> shift & 511) * scale for shift in (0, 9, 18))


def check(path):
    head, *lines = path.with_suffix(".txt").read_text().splitlines()
    vk_format, width, height, depth, layers = map(int, head.split())
    texture = parser.parse_path(path)
    found = (texture.vkFormat.value, texture.pixelWidth, texture.pixelHeight, texture.pixelDepth,
             texture.layerCount)
    assert found == (vk_format, width, height, depth, layers), found
    assert (texture.faceCount, texture.levelCount) == (1, 1)
    assert texture.supercompressionScheme == parser.SupercompressionScheme.NONE
    basic, samples = texture.dfd
    assert basic.colorModel == RGBSDA
    assert basic.colorPrimaries == parser.ColorPrimaries.KHR_DF_PRIMARIES_BT709
    assert basic.transferFunction == parser.TransferFunction.KHR_DF_TRANSFER_LINEAR
    assert basic.bytesPlane0 == parser.get_stride(texture.vkFormat)
    assert len(samples) == (6 if vk_format == 123 else 4)
    assert texture.kv == {"KTXorientation": b"rdi\0" if depth else b"rd\0", "KTXwriter": b"lte\0"}
    assert len(texture.levelImages) == max(depth, layers, 1)
    values = [value for image in texture.levelImages for value in texels(image.data, vk_format)]
    assert len(values) == len(lines), (len(values), len(lines))
    for i, (value, line) in enumerate(zip(values, lines)):
        expected = tuple(map(float, line.split()))
        assert all(abs(a - b) <= 1e-8 * abs(b) for a, b in zip(value, expected)), (i, value, line)


files = sorted(pathlib.Path(sys.argv[1]).glob("*.ktx2"))
assert files
for file in files:
    check(file)
print(f"check_ktx2: {len(files)} files, every texel")
