#!/usr/bin/python3
"""read_raw.py KIND FILE…: the texels of each exported file as raw bytes in FILE.raw.

Reads by the layouts that docs/reference/export_files.md and the formats' own documents give, with
nothing of
hshfit: KIND is dds, tensor, or oiio for what `oiiotool --dumpdata` printed of half floats.
"""
import re
import struct
import sys

import numpy


def dds(data):
    magic, size = struct.unpack_from("<4sI", data)
    height, width = struct.unpack_from("<II", data, 12)
    assert magic == b"DDS " and size == 124, "no DDS"
    assert data[84:88] == b"DX10", "no DX10 header"
    form, dimension, _, layers, _ = struct.unpack_from("<5I", data, 128)
    texel = {2: 16, 10: 8, 11: 8, 28: 4}[form]
    assert dimension == 3, "no 2-D texture"
    texels = data[148:]
    assert len(texels) == width * height * layers * texel, "sizes"
    return texels


def tensor(data):
    assert data[:14] == b"tensor_file\0\1\0", "no tensor file"
    (count,) = struct.unpack_from("<I", data, 14)
    at = 18
    for _ in range(count):
        (length,) = struct.unpack_from("<H", data, at)
        name = data[at + 2:at + 2 + length].decode()
        at += 2 + length
        dimensions, kind, offset = struct.unpack_from("<HBQ", data, at)
        shape = struct.unpack_from(f"<{dimensions}Q", data, at + 11)
        at += 11 + 8 * dimensions
        if name == "coefficients":
            assert shape[-1] == 4 and len(shape) == 4, "shape"
            size = {1: 1, 3: 2, 9: 2, 10: 4}[kind]
            return data[offset:offset + size * int(numpy.prod(shape))]
    raise AssertionError("no field 'coefficients'")


def oiio(data):
    # nine decimals, and neighbouring halves are at least 6e-8 apart: exact
    lanes = re.findall(r"Pixel \(\d+, \d+\): (\S+) (\S+) (\S+) (\S+)", data.decode())
    return numpy.array(lanes, dtype=numpy.float64).astype("<f2").tobytes()


if __name__ == "__main__":
    read = {"dds": dds, "tensor": tensor, "oiio": oiio}[sys.argv[1]]
    for path in sys.argv[2:]:
        with open(path, "rb") as file, open(path + ".raw", "wb") as raw:
            raw.write(read(file.read()))
