#!/usr/bin/env python3
"""transmission_evaluator.py PROGRAM FOLDER… [--pairs N] [--seed S]: blocks of real BSDF XML files.

Reads every block of visible or solar light of every BSDF XML file below the folders without
PROGRAM, and compares it with `PROGRAM eval FILE:side=… --pairs`, at N random pairs of directions
each (3000), to the last digit but four.

The evaluator works in the frame of Radiance (bsdf_m.c, bsdf_t.c): z out of the side that it calls
front, which is the file's back. Light that arrives from above, wi.z > 0, meets "… Back" and goes to
wo.z < 0 for a transmission. The patch, or the point of the square, of the incident light is that of
(-x, -y) of wi, and the one of the outgoing light is that of (x, y) of wo.

Ends with 1 if a value differs, and with 77 if there is no file.
"""
import argparse
import csv
import io
import math
import random
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree
from pathlib import Path

FULL = ([5, 15, 25, 35, 45, 55, 65, 75, 90], [1, 8, 16, 20, 24, 24, 24, 16, 12])
HALF = ([6.5, 19.5, 32.5, 45.5, 58.5, 71.5, 90], [1, 8, 12, 16, 20, 12, 8])
QUARTER = ([9, 27, 45, 63, 90], [1, 8, 12, 12, 8])
NAMED = {"lbnl/klems full": FULL, "lbnl/klems half": HALF, "lbnl/klems quarter": QUARTER}


def bare(tag):
    return tag.split("}")[-1]


def texts(node, name):
    return [e.text.strip() for e in node.iter() if bare(e.tag) == name and e.text]


def children(node, name):
    return [e for e in node.iter() if bare(e.tag) == name]


class Klems:
    """A matrix of patch pairs."""

    def __init__(self, block, bases, rows_are_incident):
        self.incident = bases[texts(block, "ColumnAngleBasis")[0].lower()]
        self.outgoing = bases[texts(block, "RowAngleBasis")[0].lower()]
        numbers = texts(block, "ScatteringData")[0].replace(",", " ").split()
        self.values = [max(float(v), 0) for v in numbers]
        self.transposed = rows_are_incident

    @staticmethod
    def patch(basis, x, y, z):
        theta = math.degrees(math.acos(min(max(z, -1), 1)))
        uppers, counts = basis
        first = 0
        for upper, count in zip(uppers, counts):
            if theta < upper or upper == uppers[-1]:
                turn = math.degrees(math.atan2(y, x)) % 360
                return first + int(turn / 360 * count + 0.5) % count
            first += count
        return None

    def at(self, wi, wo):
        i = self.patch(self.incident, -wi[0], -wi[1], abs(wi[2]))
        o = self.patch(self.outgoing, wo[0], wo[1], abs(wo[2]))
        ni, no = sum(self.incident[1]), sum(self.outgoing[1])
        return self.values[i * no + o if self.transposed else o * ni + i]


def square(x, y):
    """The disc onto the unit square (Shirley & Chiu 1997), by the angle in quarters."""
    r, phi = math.hypot(x, y), math.atan2(y, x)
    if phi < -math.pi / 4:
        phi += 2 * math.pi
    quarter = math.pi / 4
    if phi < quarter:
        a, b = r, phi * r / quarter
    elif phi < 3 * quarter:
        a, b = -(phi - 2 * quarter) * r / quarter, r
    elif phi < 5 * quarter:
        a, b = -r, -(phi - 4 * quarter) * r / quarter
    else:
        a, b = (phi - 6 * quarter) * r / quarter, -r
    return (a + 1) / 2, (b + 1) / 2


class Tree:
    """A tensor tree of rank 3 or 4, as nested lists."""

    def __init__(self, block, rank):
        self.rank = rank
        text = texts(block, "ScatteringData")[0]
        for mark in "{}":
            text = text.replace(mark, f" {mark} ")
        self.tokens = text.replace(",", " ").split()
        self.position = 0
        self.root = self.read()

    def read(self):
        assert self.tokens[self.position] == "{"
        self.position += 1
        items = []
        while self.tokens[self.position] != "}":
            if self.tokens[self.position] == "{":
                items.append(self.read())
            else:
                items.append(float(self.tokens[self.position]))
                self.position += 1
        self.position += 1
        return items

    def look(self, node, point):
        while isinstance(node[0], list):
            child = 0
            for k, v in enumerate(point):
                if v >= 0.5:
                    child |= 1 << k
            point = [2 * v - (v >= 0.5) for v in point]
            node = node[child]
        steps = round(len(node) ** (1 / self.rank))
        index = 0
        for v in point:
            index = index * steps + min(int(v * steps), steps - 1)
        return max(node[index], 0)

    def at(self, wi, wo):
        if self.rank == 4:
            return self.look(self.root, [*square(-wi[0], -wi[1]), *square(wo[0], wo[1])])
        turn = -math.atan2(-wi[1], -wi[0])
        x = math.cos(turn) * wo[0] - math.sin(turn) * wo[1]
        y = math.sin(turn) * wo[0] + math.cos(turn) * wo[1]
        return self.look(self.root, [0.5 - 1e-6 - 0.5 * math.hypot(wi[0], wi[1]), *square(x, y)])


def blocks(path):
    """(direction, wavelength, evaluator) of the first layer of a file."""
    root = ElementTree.parse(path).getroot()
    structure = texts(root, "IncidentDataStructure")[0]
    bases = dict(NAMED)
    for basis in children(root, "AngleBasis"):
        rings = children(basis, "AngleBasisBlock")
        if not rings:
            continue
        bases[texts(basis, "AngleBasisName")[0].lower()] = (
            [float(texts(r, "UpperTheta")[0]) for r in rings],
            [int(texts(r, "nPhis")[0]) for r in rings])
    for data in children(root, "WavelengthData"):
        wavelength = texts(data, "Wavelength")[0].lower()
        for block in children(data, "WavelengthDataBlock"):
            direction = texts(block, "WavelengthDataDirection")[0].lower()
            if structure.lower().startswith("tensortree"):
                yield direction, wavelength, Tree(block, int(structure[-1]))
            else:
                yield direction, wavelength, Klems(block, bases, structure.lower() == "rows")


def hemisphere(draw):
    """Uniform over the disc, a little more often than that towards the horizon."""
    r = math.sqrt(draw.random()) if draw.random() < 0.7 else draw.random() ** 0.2
    phi = draw.uniform(0, 2 * math.pi)
    return r * math.cos(phi), r * math.sin(phi), math.sqrt(max(1 - r * r, 1e-12))


def differences(program, path, direction, wavelength, block, count, draw):
    kind, side = direction.split()
    lower = -1 if kind == "transmission" else 1
    # The program's frame has +z towards the light; of the file's front it is turned about y.
    flip = -1 if side == "front" else 1
    pairs, expected = [], []
    for _ in range(count):
        wi, wo = hemisphere(draw), hemisphere(draw)
        wo = (wo[0], wo[1], lower * wo[2])
        pairs.append((*wi, *wo))
        expected.append(block.at((flip * wi[0], wi[1], flip * wi[2]),
                                 (flip * wo[0], wo[1], flip * wo[2])))
    with tempfile.NamedTemporaryFile("w", suffix=".csv", delete=False) as file:
        writer = csv.writer(file)
        writer.writerow(["wi_x", "wi_y", "wi_z", "wo_x", "wo_y", "wo_z"])
        writer.writerows(pairs)
    option = f":side={kind}-{side},wavelength={wavelength}"
    try:
        out = subprocess.run([program, "eval", str(path) + option, "--pairs", file.name],
                             check=True, capture_output=True, text=True).stdout
    finally:
        Path(file.name).unlink()
    found = [float(row["g"]) for row in csv.DictReader(io.StringIO(out))]
    assert len(found) == count
    # Borders of patches are hit by no pair but to rounding.
    wrong = sum(abs(f - e) > 1e-12 * max(e, 1e-30) for f, e in zip(found, expected))
    return wrong, sum(e > 0 for e in expected)


def main():
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("program")
    arguments.add_argument("folders", nargs="+")
    arguments.add_argument("--pairs", type=int, default=3000)
    arguments.add_argument("--seed", type=int, default=1)
    options = arguments.parse_args()
    draw = random.Random(options.seed)
    files = sorted(p for folder in options.folders for p in Path(folder).rglob("*.xml"))
    files = [p for p in files if b"<WindowElement" in p.read_bytes()]
    if not files:
        print("no BSDF XML file below " + ", ".join(options.folders))
        return 77
    bad = 0
    for path in files:
        for direction, wavelength, block in blocks(path):
            wrong, lit = differences(options.program, path, direction, wavelength, block,
                                     options.pairs, draw)
            print(f"{path.name}: {direction}, {wavelength}: {wrong} of {options.pairs} differ, "
                  f"{lit} above 0")
            bad += wrong
    return bad > 0


if __name__ == "__main__":
    sys.exit(main())
