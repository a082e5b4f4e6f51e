#!/usr/bin/env python3
"""simulate.py HSHFIT > scans.csv: readings of a goniometer as the program HSHFIT evaluates a paint.

Twelve scans in the plane of incidence, two for each of six angles. A reading has independent noise,
which its column sigma states, and the readings of a scan share a scale, whose standard deviation
is SCALE. The same seed gives the same bytes.
"""
import math
import random
import subprocess
import sys
import tempfile

PAINT = "lambert:kd=0.4+ggx:alpha=0.25,F0=0.05,ks=1"
NOISE, FLOOR, SCALE = 0.01, 0.0004, 0.01  # relative, 1/sr, relative
INCIDENCE = (0, 15, 30, 45, 60, 70)


def direction(theta, azimuth):
    """A unit vector; angles in degrees, those below 0 on the other side of the normal."""
    t, a = math.radians(theta), math.radians(azimuth)
    return math.sin(t) * math.cos(a), math.sin(t) * math.sin(a), math.cos(t)


def values(program, angles):
    """f of the paint at pairs of angles; the mirror direction is at theta_o = theta_i."""
    with tempfile.NamedTemporaryFile("w", suffix=".csv") as pairs:
        print("wi_x,wi_y,wi_z,wo_x,wo_y,wo_z", file=pairs)
        for incoming, outgoing in angles:
            numbers = direction(incoming, 0) + direction(outgoing, 180)
            print(",".join(f"{number:.17g}" for number in numbers), file=pairs)
        pairs.flush()
        done = subprocess.run([program, "eval", PAINT, "--pairs", pairs.name], check=True,
                              capture_output=True, text=True)
    return [float(line.split(",")[6]) for line in done.stdout.splitlines()[1:]]


def main():
    chance = random.Random(7)
    scans = [(theta, scan) for scan, theta in enumerate(sorted(INCIDENCE * 2), 1)]
    # The detector stands in the light about the direction of the source.
    rows = [(theta, out, scan) for theta, scan in scans for out in range(-75, 80, 5)
            if abs(theta + out) > 4]
    scales = {scan: 1 + SCALE * chance.gauss(0, 1) for _, scan in scans}
    print("theta_i (deg),theta_o (deg),BRDF,sigma,scan")
    for (theta, out, scan), f in zip(rows, values(sys.argv[1], [row[:2] for row in rows])):
        sigma = math.hypot(NOISE * f, FLOOR)
        reading = scales[scan] * (f + sigma * chance.gauss(0, 1))
        print(f"{theta},{out},{reading:.5g},{sigma:.3g},{scan}")


if __name__ == "__main__":
    main()
