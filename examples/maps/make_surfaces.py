#!/usr/bin/env python3
"""Writes maps of turned texels, 128 x 128, by formulas: bumps, brushed streaks, a turned disc.

    examples/maps/make_surfaces.py FOLDER [SIDE]

bumpy.png and brushed.png are normals (x right, y up; v of 0 to 255 stands for 2 v / 255 - 1),
disc_direction.png the direction of grooves as glTF's anisotropy texture has it (R, G the vector,
B the strength), disc_roughness.png a grey map. All tile but the disc.
"""
import math
import random
import sys

from make_coin import png


def waves(count, draw):
    """(cycles along x, cycles along y, phase, slope along x, slope along y)"""
    return [draw(k) + (2 * math.pi * random.random(),) for k in range(count)]


def bumps(side, sigma=0.3, count=64):
    """Slopes of a Gaussian height field of wavelengths from 8 to 32 texels, tiling."""
    def draw(k):
        cycles = side / (8 * 4 ** random.random())
        angle = 2 * math.pi * (k + random.random()) / count
        kx, ky = round(cycles * math.cos(angle)), round(cycles * math.sin(angle))
        scale = 2 * sigma / math.sqrt(count) / max(math.hypot(kx, ky), 1)
        return kx, ky, scale * kx, scale * ky
    return waves(count, draw)


def streaks(side, across=0.3, along=0.05, count=64):
    """Streaks along x: slopes vary over 3 to 12 texels across and over all of the map along."""
    def draw(_):
        kx, ky = random.choice((-1, 0, 1)), round(side / (3 * 4 ** random.random()))
        scale = math.sqrt(2 / count)
        return kx, ky, scale * along * random.choice((-1, 1)), scale * across
    return waves(count, draw)


def normals(field):
    def value(x, y):
        sx = sy = 0
        for kx, ky, ax, ay, phase in field:
            c = math.cos(2 * math.pi * (kx * x + ky * y) + phase)
            sx += ax * c
            sy += ay * c
        # Rows run downwards and y upwards.
        length = math.sqrt(sx * sx + sy * sy + 1)
        return [0.5 - 0.5 * sx / length, 0.5 + 0.5 * sy / length, 0.5 + 0.5 / length]
    return value


def grooves(x, y):
    """Along circles about the middle; strength falls towards it."""
    dx, dy = x - 0.5, 0.5 - y
    r = max(math.hypot(dx, dy), 1e-9)
    return [0.5 - 0.5 * dy / r, 0.5 + 0.5 * dx / r, min(1, 2 * r)]


def main():
    folder, side = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 128
    random.seed(1)
    png(f'{folder}/bumpy.png', side, 3, normals(bumps(side)))
    png(f'{folder}/brushed.png', side, 3, normals(streaks(side)))
    png(f'{folder}/disc_direction.png', side, 3, grooves)
    png(f'{folder}/disc_roughness.png', side, 1,
        lambda x, y: [0.35 + 0.25 * math.sin(40 * math.hypot(x - 0.5, y - 0.5)) ** 2])


if __name__ == '__main__':
    main()
