#!/usr/bin/env python3
"""Writes measured.tensor: 16 x 16 texels of GGX by its published formula, as if they were measured.

    examples/maps/make_measured.py FOLDER [SIDE]

f = kd / pi + F D G / (4 cos_i cos_o) (Walter et al. 2007, height-correlated G of Heitz 2014,
Schlick's F), roughness rising to the right and albedo downwards, with noise of 1 %.
"""
import math
import random
import struct
import sys


def directions(rings, spokes, lowest):
    """Unit vectors on rings down to an angle from the normal, radians."""
    result = [] if spokes > 1 else [(0.0, 0.0, 1.0)]
    for ring in range(rings):
        theta = lowest * (ring + (0.5 if spokes > 1 else 1)) / rings
        for spoke in range(spokes):
            phi = 2 * math.pi * (spoke + 0.5 * (ring % 2)) / spokes if spokes > 1 else 0
            result.append((math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi),
                           math.cos(theta)))
    return result


def ggx(wi, wo, alpha, kd, f0):
    h = [a + b for a, b in zip(wi, wo)]
    length = math.sqrt(sum(v * v for v in h))
    z = h[2] / length
    cosine = sum(a * b for a, b in zip(h, wo)) / length
    d = alpha ** 2 / (math.pi * (1 + z * z * (alpha ** 2 - 1)) ** 2)

    def under(a, b):
        return a * math.sqrt(b * b + alpha ** 2 * (1 - b * b))
    visible = 0.5 / (under(wi[2], wo[2]) + under(wo[2], wi[2]))
    return kd / math.pi + (f0 + (1 - f0) * (1 - cosine) ** 5) * d * visible


def main():
    folder, side = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 16
    random.seed(1)
    incoming, outgoing = directions(10, 24, math.radians(85)), directions(6, 1, math.radians(75))
    values = []
    for y in range(side):
        for x in range(side):
            alpha, kd = 0.3 + 0.4 * x / side, 0.1 + 0.6 * y / side
            values += [max(0, ggx(wi, wo, alpha, kd, 0.5) * random.gauss(1, 0.01))
                       for wo in outgoing for wi in incoming]
    fields = [('incoming', (len(incoming), 3), [v for d in incoming for v in d]),
              ('outgoing', (len(outgoing), 3), [v for d in outgoing for v in d]),
              ('reflectance', (side, side, len(outgoing), len(incoming), 1), values)]
    head = 18 + sum(2 + len(name) + 2 + 1 + 8 + 8 * len(shape) for name, shape, _ in fields)
    offset = (head + 7) // 8 * 8
    with open(f'{folder}/measured.tensor', 'wb') as file:
        file.write(b'tensor_file\0' + struct.pack('<BBI', 1, 0, len(fields)))
        for name, shape, data in fields:
            file.write(struct.pack('<H', len(name)) + name.encode() +
                       struct.pack('<HBQ', len(shape), 10, offset) +
                       struct.pack(f'<{len(shape)}Q', *shape))
            offset += (4 * len(data) + 7) // 8 * 8
        for _, _, data in fields:
            file.write(b'\0' * (-file.tell() % 8) + struct.pack(f'<{len(data)}f', *data))


if __name__ == '__main__':
    main()
