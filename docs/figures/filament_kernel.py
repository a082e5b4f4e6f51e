#!/usr/bin/env python3
"""filament_kernel.py FOLDER [SIZE]: the kernels of the levels that Filament's cmgen prefilters.

cmgen (Debian's libfilament-tools) filters pictures with one narrow spot to cubes of SIZE texels,
256 if not given. Coefficients of each level in Legendre polynomials about the spot, over those of
level 0, are those of the level's kernel, looked up with a filter. Prints the table of
docs/explanation/prefiltered.md: for each level its roughness; for a spot in the middle of a face,
between and at a corner the light that is left, and the largest difference of 32 coefficients from
the kernel that `--engine filament` reckons with, both being 1 in band 0; the roughness whose
kernel is nearest.
"""

import struct
import subprocess
import sys
from pathlib import Path

import numpy

BANDS = 32
FACES = ('px', 'nx', 'py', 'ny', 'pz', 'nz')
WIDTH = numpy.radians(3)
# Places of the spot by where they are on a face; the picture's y is up.
SPOTS = {'middle of a face': (0, 0, -1), 'between': (0.3, 0.5, -0.81), 'corner': (1, 1, -1)}


def write_picture(path, spot):
    height, width = 512, 1024
    theta, phi = numpy.meshgrid((numpy.arange(height) + .5) / height * numpy.pi,
                                (numpy.arange(width) + .5) / width * 2 * numpy.pi, indexing='ij')
    across = numpy.sin(theta)
    cosine = (spot[0] * across * numpy.sin(phi) + spot[1] * numpy.cos(theta)
              - spot[2] * across * numpy.cos(phi)) / numpy.linalg.norm(spot)
    value = numpy.maximum(1000 * numpy.exp(-(1 - cosine) / WIDTH ** 2), 1e-30)
    exponent = numpy.ceil(numpy.log2(value) + 1e-9)
    texels = numpy.zeros((height, width, 4), numpy.uint8)
    texels[..., :3] = numpy.clip(numpy.round(value / 2 ** exponent * 256), 0, 255)[..., None]
    texels[..., 3] = numpy.where(value > 1e-20, numpy.clip(exponent + 128, 0, 255), 0)
    out = f'#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n'.encode()
    literal = 128
    for row in texels:
        out += bytes([2, 2, width >> 8, width & 255])
        for channel in range(4):
            for first in range(0, width, literal):
                out += bytes([literal]) + row[first:first + literal, channel].tobytes()
    path.write_bytes(out)


def texel_places(size):
    """Directions and solid angles of a face's texels, faces +x -x +y -y +z -z as in OpenGL."""
    across = (numpy.arange(size) + .5) / size * 2 - 1
    v, u = numpy.meshgrid(across, across, indexing='ij')
    one = numpy.ones_like(u)
    faces = [(one, -v, -u), (-one, -v, u), (u, one, v), (u, -one, -v), (u, -v, one), (-u, -v, -one)]
    length = numpy.sqrt(1 + u * u + v * v)
    corner = numpy.linspace(-1, 1, size + 1)
    y, x = numpy.meshgrid(corner, corner, indexing='ij')
    area = numpy.arctan2(x * y, numpy.sqrt(x * x + y * y + 1))
    solid = area[1:, 1:] - area[:-1, 1:] - area[1:, :-1] + area[:-1, :-1]
    return [numpy.stack(face, -1) / length[..., None] for face in faces], solid


def read_face(path):
    """The red plane of a picture of Photoshop with 32 bits: planes are the file's end."""
    data = path.read_bytes()
    channels, height, width, depth = struct.unpack('>HIIH', data[12:24])
    assert depth == 32, path
    planes = numpy.frombuffer(data[-4 * channels * height * width:], '>f4')
    return planes.reshape(channels, height, width)[0].astype(float)


def level_faces(folder, level):
    return [read_face(folder / f'm{level}_{axis}.psd') for axis in FACES]


def looked_up(faces, size):
    """Faces of that size by a linear filter, which ends at the edges."""
    count = faces[0].shape[0]
    place = numpy.clip((numpy.arange(size) + .5) * count / size - .5, 0, count - 1)
    below = numpy.minimum(place.astype(int), count - 2)
    share = place - below
    wide = [face[:, below] * (1 - share) + face[:, below + 1] * share for face in faces]
    return [(face[below].T * (1 - share) + face[below + 1].T * share).T for face in wide]


def legendre(x):
    before, here = numpy.zeros_like(x), numpy.ones_like(x)
    for n in range(BANDS):
        yield here
        before, here = here, ((2 * n + 1) * x * here - n * before) / (n + 1)


def coefficients(faces, axis):
    places, solid = texel_places(faces[0].shape[0])
    result = numpy.zeros(BANDS)
    for face, place in zip(faces, places):
        weight = face * solid
        result += [numpy.sum(weight * p) for p in legendre(place @ axis)]
    return result


def spot_axis(faces):
    places, solid = texel_places(faces[0].shape[0])
    mean = sum(numpy.einsum('ij,ijk->k', face * solid, place) for face, place in zip(faces, places))
    return mean / numpy.linalg.norm(mean)


def kernel_bands(roughness):
    """As hshfit's kernelBands (lib/hshfit/lighting/prefilter.cpp)."""
    alpha2, steps, narrowest = roughness ** 4, 4000, 1e-7
    step = -numpy.log(narrowest) / steps
    t2 = (narrowest * numpy.exp((numpy.arange(steps) + .5) * step)) ** 2
    x, d = (1 - t2) / (1 + t2), (alpha2 + t2) / (1 + t2)
    weight = t2 / (1 + t2) ** 2 * x / d ** 2
    bands = numpy.array([numpy.sum(weight * p) for p in legendre(x)])
    return bands / bands[0]


def distance(found, expected):
    """Relative L2 of two round kernels in these bands."""
    share = 2 * numpy.arange(BANDS) + 1
    return numpy.sqrt(numpy.sum(share * (found - expected) ** 2) / numpy.sum(share * expected ** 2))


def filtered(folder, name, size):
    """The folder of the levels that cmgen makes of the picture with a spot."""
    folder = folder / name.split()[0]
    folder.mkdir(parents=True, exist_ok=True)
    write_picture(folder / 'spot.hdr', SPOTS[name])
    subprocess.run(['cmgen', '-q', '--format=psd', '-c', '32', f'--size={size}',
                    f'--ibl-ld={folder / "levels"}', folder / 'spot.hdr'], check=True)
    return folder / 'levels' / 'spot'


def main():
    folder, size = Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 256
    print('| spot | level | roughness | light left | largest difference | nearest roughness |')
    print('|---|---|---|---|---|---|')
    for name in SPOTS:
        levels = filtered(folder, name, size)
        count = len(list(levels.glob('m*_px.psd')))
        first = level_faces(levels, 0)
        axis = spot_axis(first)
        whole = coefficients(first, axis)
        for level in range(1, count):
            found = coefficients(looked_up(level_faces(levels, level), size), axis) / whole
            left = found[0]
            roughness = 1 - numpy.sqrt(1 - level / (count - 1))  # of level = (count - 1) r (2 - r)
            gap = numpy.max(abs(found / left - kernel_bands(roughness)))
            tried = numpy.linspace(max(.02, roughness - .1), min(1, roughness + .1), 201)
            nearest = min(tried, key=lambda r: distance(found / left, kernel_bands(r)))
            numbers = (f'{value:.3f}' for value in (roughness, left, gap, nearest))
            print(f'| {name} | {level} |', ' | '.join(numbers), '|', flush=True)


if __name__ == '__main__':
    main()
