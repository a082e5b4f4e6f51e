#!/usr/bin/env python3
"""Prints the errors of fills in docs/reference/conversion.md: docs/figures/hole_errors.py PROGRAM
TABLE

PROGRAM is build/hshfit, TABLE a full table in MERL's layout. Cells of it are marked as not
measured: a blind spot of 3 degrees about retroreflection, then all beyond an arm's 80 and 70
degrees. Those that `convert --repair holes` fills are compared with the table.
"""
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

SHAPE = (3, 90, 90, 180)  # channels, theta_h, theta_d, phi_d


def cell_angles():
    """Of the middles of cells, degrees: theta_h, theta_d, and the larger polar angle, infinite
    below the horizon."""
    half = np.radians((np.arange(90) + 0.5) ** 2 / 90)
    theta, phi = np.radians(np.arange(90) + 0.5), np.radians(np.arange(180) + 0.5)
    half, theta, phi = np.meshgrid(half, theta, phi, indexing="ij")
    across = np.sin(half) * np.sin(theta) * np.cos(phi)
    lower = np.cos(half) * np.cos(theta) - np.abs(across)
    polar = np.degrees(np.arccos(np.clip(lower, -1, 1)))
    return np.degrees(half), np.degrees(theta), np.where(lower > 0, polar, np.inf)


def main():
    program, table = sys.argv[1:]
    content = pathlib.Path(table).read_bytes()
    truth = np.frombuffer(content[12:], "<f8").reshape(SHAPE)
    half, difference, polar = cell_angles()
    measured = (truth >= 0).all(0) & np.isfinite(polar)
    for name, hole in (("blind spot of 3 degrees", difference < 3),
                       ("beyond 80 degrees", polar > 80), ("beyond 70 degrees", polar > 70)):
        with tempfile.TemporaryDirectory() as folder:
            cut, filled = f"{folder}/cut.binary", f"{folder}/filled.binary"
            values = np.where(hole, -1, truth)
            pathlib.Path(cut).write_bytes(content[:12] + values.astype("<f8").tobytes())
            done = subprocess.run([program, "convert", cut, filled, "--repair", "holes"],
                                  check=True, capture_output=True, text=True)
            result = np.frombuffer(pathlib.Path(filled).read_bytes()[12:], "<f8").reshape(SHAPE)
        # A pair without a neighbour is left, and written as 0.
        cells = hole & measured & (result > 0).all(0)
        left = (hole & measured & ~cells).sum()
        errors = np.abs(result[:, cells] / np.maximum(truth[:, cells], 1e-12) - 1)
        angles = np.stack([angle[cells] for angle in (half, difference, polar)])
        half_of, difference_of, polar_of = angles[:, errors.max(0).argmax()]
        print(f"{name}: {cells.sum()} cells filled, {left} left, median {np.median(errors):.2%}, "
              f"95 of 100 up to {np.percentile(errors, 95):.2%}, at most {errors.max():.0%} at "
              f"theta_h {half_of:.1f}, theta_d {difference_of:.1f}, larger polar angle "
              f"{polar_of:.1f} degrees")
        print(next(line for line in done.stdout.splitlines() if "held out" in line))


main()
