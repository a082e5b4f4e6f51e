#!/usr/bin/env python3
"""rgl_rings.py PROGRAM FILE FOLDER: the rings and the dent that pictures of an RGL file show.

FILE is isotropic, as cc_ibiza_sunset_rgb.bsdf. Writes FOLDER/rgl_rings.svg (the slope of ln f
beside that of ln ndf; f around the normal) and FOLDER/rgl_rings.png (spheres by both readings
under three lamps); prints the table of docs/reference/measured.md. Needs gnuplot and oiiotool.
"""

import csv
import math
import struct
import subprocess
import sys
from pathlib import Path

LAMPS = ['5,135,1', '40,135,1', '75,30,1']
READINGS = ['published', 'smooth']


def field(file, wanted):
    """Shape and values of a field of 32-bit floats of a tensor file."""
    data = file.read_bytes()
    count, = struct.unpack_from('<I', data, 14)
    at = 18
    for _ in range(count):
        length, = struct.unpack_from('<H', data, at)
        name = data[at + 2:at + 2 + length].decode()
        at += 2 + length
        dimensions, _, offset = struct.unpack_from('<HBQ', data, at)
        shape = struct.unpack_from(f'<{dimensions}Q', data, at + 11)
        at += 11 + 8 * dimensions
        if name == wanted:
            return shape, struct.unpack_from(f'<{math.prod(shape)}f', data, offset)
    raise KeyError(wanted)


def direction(theta, phi):
    theta, phi = math.radians(theta), math.radians(phi)
    return math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta)


def mirrored(wi, h):
    twice = 2 * sum(a * b for a, b in zip(wi, h))
    return tuple(twice * b - a for a, b in zip(wi, h))


def evaluated(program, spec, pairs, folder):
    """The green channel at pairs of wi and wo."""
    path = folder / 'pairs.csv'
    with path.open('w', newline='') as out:
        rows = csv.writer(out)
        rows.writerow(['wi_x', 'wi_y', 'wi_z', 'wo_x', 'wo_y', 'wo_z'])
        rows.writerows([*wi, *wo] for wi, wo in pairs)
    answer = subprocess.run([program, 'eval', spec, '--pairs', path, '--quiet'], check=True,
                            capture_output=True, text=True).stdout
    return [float(row[-2]) for row in list(csv.reader(answer.splitlines()))[1:]]


def slopes(values, step):
    return [(math.log(b) - math.log(a)) / step if a > 0 and b > 0 else 0
            for a, b in zip(values, values[1:])]


def bend(values):
    """The mean change of slope from sample to sample."""
    found = slopes(values, 1)
    return sum(abs(b - a) for a, b in zip(found, found[1:])) / (len(found) - 1)


def spheres(program, file, folder):
    strips = []
    for lamp in LAMPS:
        strips.append(folder / f'lamp{len(strips)}.png')
        subprocess.run([program, 'render', *(f'{file}:reading={r}' for r in READINGS), '-o',
                        strips[-1], '--by', 'integration', '--light', lamp, '--dome', '0', '--size',
                        '256', '--force', '--quiet'], check=True)
    subprocess.run(['oiiotool', *strips, '--mosaic:pad=2', f'{len(strips)}x1', '--ch', 'R,G,B',
                    '-o', folder / 'rgl_rings.png'], check=True)


def main():
    program, file, folder = sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3])
    folder.mkdir(parents=True, exist_ok=True)
    shape, ndf = field(file, 'ndf')
    theta_i = math.degrees(field(file, 'theta_i')[1][2])
    step = 0.25
    thetas = [step * k for k in range(1, int(40 / step))]
    wi = direction(theta_i, 0)
    across = [(wi, mirrored(wi, direction(theta, 90))) for theta in thetas]
    turns = range(0, 361, 3)
    around = [(direction(1e-4, -turn), direction(20, 0)) for turn in turns]
    data = ['$ndf << END']
    nodes = [90 * (k / (shape[1] - 1))**2 for k in range(shape[1])]
    for a, b, x, y in zip(nodes, nodes[1:], ndf, ndf[1:]):
        if 0 < b < 40 and x > 0 and y > 0:
            data.append(f'{(a + b) / 2} {(math.log(y) - math.log(x)) / (b - a)}')
    data.append('END')
    print('| reading | mean change of slope of ln f | f around the normal, largest / smallest |')
    print('|---|---|---|')
    for reading in READINGS:
        spec = f'{file}:reading={reading}'
        f = evaluated(program, spec, across, folder)
        f0 = evaluated(program, spec, around, folder)
        print(f'| {reading} | {bend(f[int(20 / step)::3]):.4f} | {max(f0) / min(f0):.2f} |')
        data += [f'${reading} << END']
        data += [f'{x + step / 2} {y}' for x, y in zip(thetas, slopes(f, step))] + ['END']
        data += [f'${reading}0 << END', *(f'{x} {y}' for x, y in zip(turns, f0)), 'END']
    commands = ['set terminal svg size 900,340 background "white"',
                f'set output "{folder / "rgl_rings.svg"}"', *data, 'set multiplot layout 1,2',
                f'set title "Across the plane of incidence, theta_i = {theta_i:.1f}"',
                'set xlabel "theta_h, degrees"', 'set ylabel "slope, 1 / degree"',
                'set yrange [-0.8:0.4]', 'set key bottom left',
                'plot $ndf w lines lw 2 lc "#bbbbbb" t "ln ndf of the file", '
                '$published w lines lc "#cc3311" t "ln f, published", '
                '$smooth w lines lw 2 lc "#0077bb" t "ln f, smooth"',
                'set title "wi at the normal, theta_o = 20"',
                'set xlabel "azimuth between wi and wo, degrees"', 'set ylabel "f, green"',
                'set yrange [0:*]', 'set key top center', 'set xrange [0:360]', 'set xtics 90',
                'plot $published0 w lines lc "#cc3311" t "published", '
                '$smooth0 w lines lw 2 lc "#0077bb" t "smooth"', 'unset multiplot']
    subprocess.run(['gnuplot'], input='\n'.join(commands), text=True, check=True)
    spheres(program, file, folder)


if __name__ == '__main__':
    main()
