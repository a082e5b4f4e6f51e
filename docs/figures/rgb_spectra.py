#!/usr/bin/python3
"""The spectra of red, green and blue in brdfs/measured/rgl_pbrt.cpp.

    docs/figures/rgb_spectra.py

Reads the colour-matching functions and D65 of lib/hshfit/brdf/cie_1931.cpp. Spectra are linear
between 400 and 700 nm by 20 nm and constant beyond. Of all that are not negative, sum to 1 and
have the colours (1, 0, 0), (0, 1, 0) and (0, 0, 1) in linear Rec. 709 under D65, the program prints
those with the least sum of squared differences of neighbours, and how far the colours of the
rounded numbers are off. Needs SciPy.
"""

import pathlib
import re

import numpy
from scipy.optimize import minimize

TABLE = pathlib.Path(__file__).parents[2] / "lib/hshfit/brdf/cie_1931.cpp"
NODES = numpy.arange(400.0, 701.0, 20.0)


def colour_sums():
    """Linear Rec. 709 of a spectrum as a product with its values at the nodes."""
    rows = re.findall(r"\{([\d.]+(?:, [\d.]+){3})\}", TABLE.read_text())
    x, y, z, power = numpy.array([[float(v) for v in row.split(", ")] for row in rows]).T
    at = 380 + 5 * numpy.arange(len(x))
    hats = numpy.array([numpy.interp(at, NODES, hat) for hat in numpy.eye(len(NODES))])
    xyz = (power * numpy.array([x, y, z])) @ hats.T / (power * y).sum()
    primaries = numpy.array([[a / b, 1, (1 - a - b) / b]
                             for a, b in ((.64, .33), (.3, .6), (.15, .06))]).T
    scale = numpy.linalg.solve(primaries, xyz.sum(axis=1))
    return numpy.linalg.inv(primaries * scale) @ xyz


def main():
    sums, count = colour_sums(), len(NODES)
    steps = numpy.diff(numpy.eye(count), axis=0)
    # With the sum of 1, six of the nine colours are left to be asked for.
    asked = [0, 1, 3, 4, 6, 7]
    constraints = [
        {"type": "eq",
         "fun": lambda v: (sums @ v.reshape(count, 3) - numpy.eye(3)).ravel()[asked],
         "jac": lambda v: numpy.kron(sums, numpy.eye(3))[asked]},
        {"type": "eq", "fun": lambda v: v.reshape(count, 3).sum(axis=1) - 1,
         "jac": lambda v: numpy.kron(numpy.eye(count), numpy.ones(3))}]
    found = minimize(lambda v: ((steps @ v.reshape(count, 3)) ** 2).sum(),
                     numpy.full(3 * count, 1 / 3),
                     jac=lambda v: (2 * steps.T @ steps @ v.reshape(count, 3)).ravel(),
                     bounds=[(0, 1)] * (3 * count), constraints=constraints, method="SLSQP",
                     options={"maxiter": 2000, "ftol": 1e-14})
    if not found.success:
        raise SystemExit(found.message)
    spectra = numpy.round(found.x.reshape(count, 3), 6)
    for row in spectra:
        print("    {%.6fF, %.6fF, %.6fF}," % tuple(abs(row)))
    print("largest error of a colour: %.1e" % abs(sums @ spectra - numpy.eye(3)).max())


if __name__ == "__main__":
    main()
