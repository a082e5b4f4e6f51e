#!/usr/bin/env python3
"""prefiltered_ring.py PROGRAM FOLDER: the ring that a lookup leaves about a small lamp.

For GGX of alpha 1/4 seen along the normal, by engine and number of lobes: the relative error of
f cos(theta_i) at angles of the light from the normal, green, from the table that
`export --lighting prefiltered` writes to FOLDER (docs/explanation/prefiltered.md).
"""

import math
import subprocess
import sys
from array import array
from pathlib import Path

ANGLES = [0, 2, 5, 10, 15, 20, 30, 40, 50, 60, 75]
LAST_LEVEL = {'three': 5, 'three-512': 6}
ALPHA, F0 = 0.25, 0.6


def shape(cosine, roughness):
    """The kernel of prefilter.h, but for its factor."""
    a2 = roughness**4
    return a2 * max(cosine, 0) / ((1 + cosine) / 2 * (a2 - 1) + 1)**2


def kernel(roughness):
    """The kernel, its integral 1 by a rule in the logarithm of tan(gamma / 2)."""
    steps, low = 4000, math.log(1e-6)
    total = 0
    for k in range(steps):
        t = math.exp(low * (k + 0.5) / steps)
        total += shape((1 - t * t) / (1 + t * t), roughness) * 8 * math.pi * t * t / (1 + t * t)**2
    total *= -low / steps
    return lambda cosine: shape(cosine, roughness) / total


def levels(engine):
    last = LAST_LEVEL[engine]
    return [None] + [kernel(1 - math.sqrt(1 - k / last)) for k in range(1, last + 1)]


def looked_up(row, lobes, kernels, cosine):
    """The sum of prefiltered_lobes.h seen along the normal, where all axes are the normal."""
    total = row[1] * kernels[-1](cosine)
    for k in range(1, lobes + 1):
        scale, roughness = row[4 * k + 1], row[4 * k + 3]
        place = (len(kernels) - 1) * roughness * (2 - roughness)
        first = min(int(place), len(kernels) - 2)
        for level, share in ((first, first + 1 - place), (first + 1, place - first)):
            if share:
                total += scale * share * kernels[level](cosine)
    return total


def truth(cosine):
    a2, h = ALPHA**2, math.sqrt((1 + cosine) / 2)
    d = a2 / math.pi / (h * h * (a2 - 1) + 1)**2
    tangent2 = 1 / cosine**2 - 1
    return d * (F0 + (1 - F0) * (1 - h)**5) / 4 * 2 / (1 + math.sqrt(1 + a2 * tangent2))


def main():
    program, folder = sys.argv[1], Path(sys.argv[2])
    print('| engine | lobes | ' + ' | '.join(f'{angle}°' for angle in ANGLES) + ' |')
    print('|---' * (2 + len(ANGLES)) + '|')
    for engine in LAST_LEVEL:
        kernels = levels(engine)
        for lobes in (1, 3):
            subprocess.run([program, 'export', f'ggx:alpha={ALPHA},F0=.9/{F0}/.3', '-o', folder,
                            '--lighting', 'prefiltered', '--engine', engine, '--lobes', str(lobes),
                            '--light', 'uniform', '--no-error', '--force'],
                           check=True, stdout=subprocess.DEVNULL)
            row = array('f')
            row.frombytes((folder / 'ggx.prefiltered.table.f32.bin').read_bytes())
            errors = []
            for angle in ANGLES:
                cosine = math.cos(math.radians(angle))
                errors.append(looked_up(row, lobes, kernels, cosine) / truth(cosine) - 1)
            print(f'| `{engine}` | {lobes} | ' + ' | '.join(f'{e:+.3f}' for e in errors) + ' |',
                  flush=True)


if __name__ == '__main__':
    main()
