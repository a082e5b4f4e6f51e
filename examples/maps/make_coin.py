#!/usr/bin/env python3
"""Writes the maps of coin.json, 64 x 64, by formulas: a worn bronze coin on wood.

    examples/maps/make_coin.py FOLDER [SIDE]    base.png, metal.png and roughness.png
"""
import math
import struct
import sys
import zlib


def png(path, side, channels, value):
    """8-bit grey or RGB; value(x, y) in 0..1 at the middles of texels, one number per channel."""
    rows = b''
    for j in range(side):
        rows += b'\0'
        for i in range(side):
            for v in value((i + 0.5) / side, (j + 0.5) / side):
                rows += bytes([max(0, min(255, round(255 * v)))])
    def chunk(name, data):
        body = name + data
        return struct.pack('>I', len(data)) + body + struct.pack('>I', zlib.crc32(body))
    head = struct.pack('>IIBBBBB', side, side, 8, 2 if channels == 3 else 0, 0, 0, 0)
    with open(path, 'wb') as file:
        file.write(b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', head) +
                   chunk(b'IDAT', zlib.compress(rows, 9)) + chunk(b'IEND', b''))


def coin(x, y):
    """1 on the coin, 0 on the wood, with an edge of a fiftieth."""
    return min(1, max(0, 0.5 + (0.4 - math.hypot(x - 0.5, y - 0.5)) / 0.02))


def wear(x, y):
    streaks = math.sin(23 * x + 7 * math.sin(9 * y)) * math.sin(19 * y + 5 * math.sin(11 * x))
    return 0.5 + 0.5 * streaks


def base(x, y):
    c, w, grain = coin(x, y), wear(x, y), 0.5 + 0.5 * math.sin(60 * y + 3 * math.sin(8 * x))
    bronze = (0.80 - 0.15 * w, 0.50 - 0.05 * w, 0.30 + 0.05 * w)
    wood = (0.45 + 0.10 * grain, 0.28 + 0.06 * grain, 0.16)
    return [c * b + (1 - c) * v for b, v in zip(bronze, wood)]


def main():
    folder, side = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 64
    png(f'{folder}/base.png', side, 3, base)
    png(f'{folder}/metal.png', side, 1, lambda x, y: [coin(x, y)])
    png(f'{folder}/roughness.png', side, 1,
        lambda x, y: [0.7 * (1 - coin(x, y)) + coin(x, y) * (0.25 + 0.35 * wear(x, y))])


if __name__ == '__main__':
    main()
