#!/usr/bin/env python3
"""Draws the patches of a Klems Full matrix, coloured by f for three incident patches.

klems_patches.py FILE.xml "Reflection Back" > klems.gp && gnuplot klems.gp   (writes klems.png)

Reads the file on its own, without hshfit. Azimuth 0 of the file is to the right.
"""
import math
import re
import sys
import xml.etree.ElementTree as xml

RINGS = [(0, 5, 1), (5, 15, 8), (15, 25, 16), (25, 35, 20), (35, 45, 24), (45, 55, 24),
         (55, 65, 24), (65, 75, 16), (75, 90, 12)]
STOPS = [(0x10, 0x10, 0x40), (0x20, 0x60, 0xa0), (0x40, 0xb0, 0x90), (0xf0, 0xe0, 0x40)]
LEAST, MOST = 0.03, 0.2
INCIDENT = [(0, "0"), (45, "40, azimuth 0"), (75, "50, azimuth 90")]


def matrix(path, direction):
    space = {"w": "http://windows.lbl.gov"}
    for block in xml.parse(path).getroot().iter("{http://windows.lbl.gov}WavelengthDataBlock"):
        if block.find("w:WavelengthDataDirection", space).text.strip() == direction:
            text = block.find("w:ScatteringData", space).text
            return [float(v) for v in re.split(r"[\s,]+", text.strip(" \t\r\n,"))]
    sys.exit(f"{path}: no block {direction}")


def colour(value):
    """On a logarithmic scale from LEAST to MOST, as the colour box shows it."""
    at = 3 * math.log(max(value, LEAST) / LEAST) / math.log(MOST / LEAST)
    k = min(int(at), 2)
    part = min(at - k, 1)
    mixed = (round(a + part * (b - a)) for a, b in zip(STOPS[k], STOPS[k + 1]))
    return "#%02x%02x%02x" % tuple(mixed)


def outline(lower, upper, middle, width):
    """Corners in the disc whose radius is the angle from the normal."""
    angles = [middle + width * (k / 12 - 0.5) for k in range(13)]
    ends = [(upper, a) for a in angles]
    if lower > 0:
        ends += [(lower, a) for a in reversed(angles)]
    elif width >= 360:
        ends = [(upper, 10 * k) for k in range(37)]
    return ends


def polygon(lower, upper, count, j, shift):
    points = []
    for theta, phi in outline(lower, upper, 360 * j / count, 360 / count):
        x = theta * math.cos(math.radians(phi)) + shift
        points.append(f"{x:.3f},{theta * math.sin(math.radians(phi)):.3f}")
    return " to ".join(points + points[:1])


def main():
    values = matrix(sys.argv[1], sys.argv[2])
    print("set terminal pngcairo size 1200,470 font 'sans,12'\nset output 'klems.png'")
    print("set size ratio -1\nunset border\nunset tics\nunset key\nset yrange [-105:105]")
    print(f"set xrange [-100:500]\nset logscale cb\nset cbrange [{LEAST}:{MOST}]")
    stops = ", ".join("%d '#%02x%02x%02x'" % (k, *stop) for k, stop in enumerate(STOPS))
    print(f"set palette defined ({stops})")
    print("set cblabel 'f in 1/sr'")
    number = 0
    for k, (incident, name) in enumerate(INCIDENT):
        patch = 0
        for lower, upper, count in RINGS:
            for j in range(count):
                number += 1
                value = values[145 * patch + incident]
                shape = polygon(lower, upper, count, j, 200 * k)
                print(f"set object {number} polygon from {shape} fillstyle solid 1 border "
                      f"lc rgb '#404040' lw 0.3 fillcolor rgb '{colour(value)}'")
                patch += 1
        print(f"set label 'incident patch {incident}: theta {name}' at {200 * k},99 center")
    print("plot NaN with points palette")


main()
