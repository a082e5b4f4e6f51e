#!/usr/bin/python3
"""map_lights.py PROGRAM OUT LIGHT [--texels N]

The light of an environment on the coin of examples/maps: the radiance that low-rank maps of it
reflect, and that a map of the form library does, against direct integration of the model's BRDF.
LIGHT is a picture; a shader's light has 5 bands of spherical harmonics, which are those of the
light turned twelve ways. Relative L2 over turns, eight elevations of wo and channels: median and
worst of N texels; and the bytes of all levels. Needs the Python package.
"""
import argparse
import json
import pathlib
import random
import statistics
import subprocess
import sys

import numpy

import hshfit

MAPS = pathlib.Path(__file__).parents[2] / "examples/maps"
COIN = MAPS / "coin.json"
sys.path.append(str(MAPS))
import make_coin  # noqa: E402
BANDS, TURNS = 5, 12
VIEWS = numpy.radians([0, 15, 30, 45, 55, 65, 75, 82])
FORMS = (("low-rank, order 4", ("--form", "low-rank", "--order", "4")),
         ("low-rank, order 9", ("--form", "low-rank", "--order", "9", "--outgoing", "16")),
         ("library", ("--form", "library")))


def hemisphere():
    """Directions and solid angles, finer towards the horizon as Gauss's rule is."""
    x, weights = numpy.polynomial.legendre.leggauss(96)
    z = (x + 1) / 2
    phi = 2 * numpy.pi * (numpy.arange(192) + 0.5) / 192
    sine = numpy.sqrt(1 - z * z)[:, None]
    both = numpy.broadcast_arrays(sine * numpy.cos(phi), sine * numpy.sin(phi), z[:, None])
    return (numpy.stack(both, -1).reshape(-1, 3),
            numpy.repeat(weights / 2 * 2 * numpy.pi / 192, 192))


def turned_light(spec, wi):
    """[turn][direction][channel] of the light in BANDS bands."""
    values = hshfit.light(spec, basis="sh", order=BANDS).values
    basis = hshfit.Basis("sh", BANDS)
    drawn = numpy.random.default_rng(3)
    turns = [numpy.linalg.qr(drawn.standard_normal((3, 3)))[0] for _ in range(TURNS)]
    return numpy.stack([basis(wi @ (q * numpy.linalg.det(q))) @ values.T for q in turns])


def radiance(spec, wi, weights, light):
    """[turn][view][channel]"""
    brdf = hshfit.open(str(spec))
    rows = []
    for theta in VIEWS:
        f = brdf(wi, [numpy.sin(theta), 0, numpy.cos(theta)])
        rows.append(numpy.einsum("n,nc,tnc->tc", weights * wi[:, 2], f, light))
    return numpy.stack(rows, 1)


def model(x, y):
    """The BRDF of a texel of the coin."""
    x, y = (x + 0.5) / 64, (y + 0.5) / 64
    c, code = make_coin.coin(x, y), lambda v: round(255 * v) / 255
    colour = [((code(v) + 0.055) / 1.055) ** 2.4 for v in make_coin.base(x, y)]  # none is dark
    rough = 0.7 * (1 - c) + c * (0.25 + 0.35 * make_coin.wear(x, y))
    return (f"gltf-pbr:baseColorFactor={'/'.join(f'{v:.9g}' for v in colour)},"
            f"metallicFactor={code(c):.9g},roughnessFactor={code(rough):.9g}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("light")
    parser.add_argument("--texels", type=int, default=24)
    arguments = parser.parse_args()
    wi, weights = hemisphere()
    light = turned_light(arguments.light, wi)
    drawn = random.Random(1)
    places = [(drawn.randrange(64), drawn.randrange(64)) for _ in range(arguments.texels)]
    truth = {place: radiance(model(*place), wi, weights, light) for place in places}
    print("| form | bytes | median | worst |\n|---|---|---|---|")
    for name, options in FORMS:
        folder = arguments.out / name.replace(", ", "-").replace(" ", "-")
        answer = json.loads(subprocess.run(
            [arguments.program, "svbrdf", COIN, "-o", folder, *options, "--checks", "0", "--force",
             "--json"], capture_output=True, check=True, text=True).stdout)
        errors = []
        for (x, y), wanted in truth.items():
            found = radiance(f"{folder}/material.json:x={x},y={y}", wi, weights, light)
            errors.append(numpy.linalg.norm(found - wanted) / numpy.linalg.norm(wanted))
        row = f"{statistics.median(errors):.3g} | {max(errors):.3g}"
        print(f"| {name} | {answer['bytes'] / 1e3:.0f} kB | {row} |", flush=True)


if __name__ == "__main__":
    main()
