"""Pixels of the EXR files that the program writes."""
import array
import itertools
import struct
import zlib


def text_at(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1


def read_exr(path):
    """R, G, B of a scan-line file with ZIP compression and 32-bit floats."""
    data = path.read_bytes()
    at, channels = 8, []
    while data[at]:
        name, at = text_at(data, at)
        _, at = text_at(data, at)
        size, = struct.unpack_from("<i", data, at)
        value = data[at + 4:at + 4 + size]
        at += 4 + size
        if name == "dataWindow":
            left, top, right, bottom = struct.unpack("<4i", value)
        if name == "channels":
            k = 0
            while value[k]:
                channel, k = text_at(value, k)
                k += 16
                channels.append(channel)
    width, height, lines = right - left + 1, bottom - top + 1, 16
    planes = {c: array.array("f") for c in channels}
    for offset in struct.unpack_from(f"<{(height + lines - 1) // lines}Q", data, at + 1):
        _, size = struct.unpack_from("<ii", data, offset)
        packed = data[offset + 8:offset + 8 + size]
        row = 4 * width * len(channels)
        if size % row:
            packed = bytes(itertools.accumulate(zlib.decompress(packed),
                                                lambda sum, x: (sum + x - 128) & 255))
            half, mixed = (len(packed) + 1) // 2, bytearray(len(packed))
            mixed[0::2], mixed[1::2] = packed[:half], packed[half:]
            packed = bytes(mixed)
        for start in range(0, len(packed), row):
            for k, channel in enumerate(channels):
                begin = start + 4 * width * k
                planes[channel].frombytes(packed[begin:begin + 4 * width])
    return {c: planes[c] for c in "RGB"}
