#!/usr/bin/python3
"""read_sums.py NAME.hsh.json…: evaluates the tests of each sidecar from the .bin beside it, with
numpy and what the sidecar says and nothing of hshfit, and prints the largest difference relative to
the largest value. For the basis hsh (Gautron et al. 2004):
B_lm = sqrt((2l+1)/(2 pi) (l-|m|)!/(l+|m|)!) P_l^|m|(2z-1) times 1, sqrt(2) cos(m phi),
sqrt(2) sin(|m| phi) for m = 0, > 0, < 0.
"""
import hashlib
import json
import math
import os
import sys

import numpy

TYPES = {"float16": "<f2", "float32": "<f4", "unorm16": "<u2", "unorm8": "<u1"}


def texels_of(sidecar, folder):
    data = sidecar["data"]
    path = next(f["path"] for f in sidecar["files"]
                if f["container"] == "bin" and f["role"] == "coef")
    with open(os.path.join(folder, path), "rb") as file:
        raw = file.read()
    assert len(raw) == data["bytes"] and hashlib.sha256(raw).hexdigest() == data["sha256"]
    shape = (data["layers"], data["height"], data["width"], 4)
    values = numpy.frombuffer(raw, TYPES[data["type"]]).astype(numpy.float64).reshape(shape)
    if data["scale"] is not None:
        scale = numpy.array(data["scale"]).reshape(data["layers"], 1, 1, 4, 2)
        values = values / {"unorm8": 255, "unorm16": 65535}[data["type"]]
        values = values * scale[..., 0] + scale[..., 1]
    return values


def sample(image, u, v):
    """Bilinear, clamped, LOD 0, as a GPU does it: texel centres at (i + 1/2)/N."""
    _, height, width, _ = image.shape
    x, y = u * width - 0.5, v * height - 0.5
    x0, y0 = math.floor(x), math.floor(y)
    total = 0
    for dy in (0, 1):
        for dx in (0, 1):
            weight = (x - x0 if dx else 1 - (x - x0)) * (y - y0 if dy else 1 - (y - y0))
            column = min(max(x0 + dx, 0), width - 1)
            row = min(max(y0 + dy, 0), height - 1)
            total = total + weight * image[:, row, column, :]
    return total


def legendre(order, z, below):
    """P[l][m] at 2z - 1 without the Condon-Shortley phase, l < order; `below` is 1 - z."""
    x, root = 2 * z - 1, 2 * math.sqrt(z * below)
    p = numpy.zeros((order + 1, order + 1))
    p[0][0] = 1
    for m in range(order):
        if m > 0:
            p[m][m] = (2 * m - 1) * root * p[m - 1][m - 1]
        p[m + 1][m] = x * (2 * m + 1) * p[m][m]
        for l in range(m + 2, order):
            p[l][m] = (x * (2 * l - 1) * p[l - 1][m] - (l + m - 1) * p[l - 2][m]) / (l - m)
    return p


def basis(order, shortley, d):
    assert order < 20
    # 1 - z from x and y: near the pole single precision does not hold it in z
    p = legendre(order, d[2], (d[0] * d[0] + d[1] * d[1]) / (1 + d[2]))
    phi = math.atan2(d[1], d[0])
    values = numpy.zeros(order * order)
    for l in range(order):
        for m in range(-l, l + 1):
            a = abs(m)
            norm = math.sqrt((2 * l + 1) / (2 * math.pi)
                             * math.factorial(l - a) / math.factorial(l + a))
            turn = 1 if m == 0 else math.sqrt(2) * (math.cos(m * phi) if m > 0
                                                    else math.sin(a * phi))
            sign = -1 if shortley and a % 2 else 1
            values[l * (l + 1) + m] = sign * norm * turn * p[l][a]
    return values


def turned(d, angle):
    c, s = math.cos(angle), math.sin(angle)
    return [c * d[0] - s * d[1], s * d[0] + c * d[1], d[2]]


def evaluate(sidecar, image, wo, wi):
    kind, scale, bias = (sidecar["map"][key] for key in ("type", "uv_scale", "uv_bias"))
    px, py = wo[0] / (1 + wo[2]), wo[1] / (1 + wo[2])
    if kind == "elevations":
        wi = turned(wi, -math.atan2(wo[1], wo[0]))
        px, py = math.hypot(px, py), 0
    texel = sample(image, bias[0] + scale[0] * px, bias[1] + scale[1] * py)
    functions = basis(sidecar["basis"]["order"], sidecar["basis"]["condon_shortley"], wi)
    slots = sidecar["slots"]
    stored = []
    for c, channel in enumerate(sidecar["stored"]):
        total = 0
        for j in range(channel["slots"]):
            if sidecar["data"]["layout"] == "rgb":
                value = texel[j][c]
            else:
                value = texel[channel["first_layer"] + j // 4][j % 4]
            total += value * functions[slots[j]]
        stored.append(total)
    return numpy.array(sidecar["to_channels"]) @ numpy.array(stored)


def main(path):
    with open(path, encoding="utf-8") as file:
        sidecar = json.load(file)
    assert sidecar["basis"]["name"] == "hsh" and sidecar["basis"]["index"] == "l*(l+1)+m"
    image = texels_of(sidecar, os.path.dirname(path))
    difference = largest = 0
    for test in sidecar["tests"]:
        value = evaluate(sidecar, image, test["wo"], test["wi"])
        difference = max(difference, numpy.abs(value - test["value"]).max())
        largest = max(largest, numpy.abs(value).max())
    assert len(sidecar["tests"]) >= 64 and largest > 0
    print(difference / largest)


if __name__ == "__main__":
    for argument in sys.argv[1:]:
        main(argument)
