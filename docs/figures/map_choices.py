#!/usr/bin/env python3
"""map_choices.py PROGRAM: forms of maps of materials by bytes and mean log errors, as tables.

Two maps of 64 x 64 texels: the coin of examples/maps, whose metal has narrow lobes, and a rough
one of the model ggx (roughness 0.4 to 0.9)."""
import json
import math
import pathlib
import struct
import subprocess
import sys
import tempfile

SIDE = 64
COIN = pathlib.Path(__file__).parents[2] / "examples/maps/coin.json"


def write_map(path, low, high, across, down):
    """A grey PFM picture of waves."""
    with open(path, "wb") as file:
        file.write(f"Pf\n{SIDE} {SIDE}\n-1.0\n".encode())
        for y in range(SIDE):
            for x in range(SIDE):
                share = 0.5 + 0.25 * math.sin(x * across) + 0.25 * math.cos(y * down)
                file.write(struct.pack("<f", low + (high - low) * share))


def rough(folder):
    write_map(folder / "alpha.pfm", 0.4, 0.9, 0.21, 0.17)
    write_map(folder / "kd.pfm", 0.05, 0.5, 0.13, 0.34)
    path = folder / "rough.json"
    maps = {name: {"map": f"{name}.pfm"} for name in ("alpha", "kd")}
    path.write_text(json.dumps({"format": "hshfit-svbrdf", "version": 1, "model": "ggx",
                                "parameters": {**maps, "ks": 0.2}}))
    return path


def choices(program, description, folder, more):
    answer = subprocess.run(
        [program, "svbrdf", description, "-o", folder, "--force", "--json", "--quiet", *more],
        check=True, capture_output=True, text=True)
    return json.loads(answer.stdout)["choices"]


def table_bytes(program, folder):
    """The table of the functions of a map of the form library, as `export` writes it."""
    answer = subprocess.run([program, "export", folder / "material.json", "-o", folder / "export",
                             "--target", "ktx2", "--force", "--json", "--quiet"],
                            check=True, capture_output=True, text=True)
    return next(file["bytes"] for file in json.loads(answer.stdout)["files"]
                if file["role"] == "functions")


def row(name, choice, shared=None):
    size = SIDE * SIDE * choice["bytes_per_texel"] + (shared or choice["shared_bytes"])
    error = choice["against_brdfs"]["log_error"]
    return f"| {name} | {size / 1e3:.3g} kB | {error['mean']:.2g} | {error['maximum']:.2g} |"


def main(program):
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place)
        for title, description in (("coin", COIN), ("rough", rough(folder))):
            print(f"| {title} | level 0 | log error, mean | maximum |\n|---|---|---|---|")
            found = choices(program, description, folder / "a",
                            ["--form", "halfway", "--clusters", "24"])
            wanted = (("outgoing", None), ("low-rank", 4), ("low-rank", 8), ("clusters", 24),
                      ("halfway", 24))
            for form, count in wanted:
                for choice in found:
                    if choice["form"] == form and count in (None, choice["count"]):
                        print(row(f"{form} {count or ''}, order 4".replace(" ,", ","), choice))
            found = choices(program, description, folder / "b",
                            ["--form", "low-rank", "--order", "9", "--outgoing", "16"])
            for choice in found:
                if (choice["form"], choice["count"]) in (("outgoing", 720), ("low-rank", 8)):
                    print(row(f"{choice['form']} {choice['count']}, order 9", choice))
            for components in (3, 7, 11, 19):
                choice, = choices(program, description, folder / "c",
                                  ["--form", "library", "--components", str(components)])
                print(row(f"library {components}", choice, table_bytes(program, folder / "c")))


if __name__ == "__main__":
    main(sys.argv[1])
