#!/usr/bin/env python3
"""precomputed_transfer.py PROGRAM SHARED OUT: the tables of docs/explanation/transfer.md, as
Markdown, and the
pictures beside them in OUT. SHARED/data has mesh/bun_zipper_res3.ply, mesh/wdas_teapot.obj and
env/stpeters_probe_latlong.hdr."""
import json
import math
import pathlib
import struct
import subprocess
import sys

program, shared, out = sys.argv[1], pathlib.Path(sys.argv[2]).resolve(), pathlib.Path(sys.argv[3])
out.mkdir(parents=True, exist_ok=True)
lights = {
    "clear sky": None,
    "even": "uniform",
    "daylight": "preetham:turbidity=3,elevation=30,azimuth=-110,radiance=1",
    "St. Peter's": f"{shared}/data/env/stpeters_probe_latlong.hdr",
    "panel": "panel:elevation=50,azimuth=-60,width=60,height=20,radiance=2",
}


def scene(name, materials, lift=0):
    mesh = shared / "data" / "mesh"
    document = {
        "format": "hshfit-scene",
        "version": 1,
        "materials": [
            {"name": key, "brdf": brdf} for key, brdf in zip(("white", "red", "blue"), materials)
        ],
        "lights": [{"light": "sky:type=12,elevation=40,azimuth=-60,radiance=1"}],
        "objects": [
            {"name": "floor", "mesh": "square", "material": "white", "scale": 3},
            {
                "name": "bunny",
                "mesh": f"{mesh}/bun_zipper_res3.ply",
                "up": "y",
                "material": "red",
                "scale": 9,
                "at": [-0.9, 0, lift - 0.3],
            },
            {
                "name": "teapot",
                "mesh": f"{mesh}/wdas_teapot.obj",
                "up": "y",
                "material": "blue",
                "scale": 0.12,
                "at": [0.9, 0, lift],
            },
        ],
        "cameras": [
            {
                "name": "front",
                "position": [1.2, -5.5, 3],
                "target": [0.1, 0, 0.5],
                "field_of_view": 34,
                "width": 128,
            }
        ],
    }
    path = out / f"{name}.json"
    path.write_text(json.dumps(document))
    return path


def transfer(path, folder, *options):
    command = [program, "transfer", path, "-o", out / folder, "--force", "--json", "--quiet"]
    done = subprocess.run([*command, *options], check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


def percent(x):
    return f"{float(f'{100 * x:.2g}'):g} %"


def row(*cells):
    print("| " + " | ".join(str(cell) for cell in cells) + " |")


def head(*cells):
    row(*cells)
    print("|" + "---|" * len(cells))


def against_paths(path, samples):
    options = [word for light in lights.values() if light for word in ("--light", light)]
    options += ["--reference-samples", samples]
    for kind in ("shadowed", "interreflected"):
        answer = transfer(path, kind, "--kind", kind, *options)
        print(f"\n{kind}: {answer['vertices']} vertices, {answer['rays']['per_vertex']} rays each")
        head("light", "energy in 25", *(f"order {n}" for n in range(1, 6)), "reference", "largest")
        for name, picture in zip(lights, answer["pictures"]):
            captured = picture["captured"]
            row(
                name,
                "none" if captured is None else percent(captured),
                *(percent(error["relative_l2"]) for error in picture["errors"]),
                percent(picture["reference_noise"]),
                percent(picture["errors"][-1]["maximum"]["relative"]),
            )
    print("\nenergy by pass:", *(f"{energy:.4g}" for energy in answer["energy"]))


def speed(path):
    print()
    head("kind", "vertices", "rays", "rays a second", "in Embree", "noise", "largest", "passes")
    for options in (
        ("--kind", "shadowed"),
        ("--kind", "interreflected"),
        ("--kind", "interreflected", "--local-order", "5", "--passes", "1", "--clusters", "0"),
    ):
        answer = transfer(path, "speed", *options)
        rays = answer["rays"]
        row(
            answer["kind"] + (", matrices" if answer["local_order"] else ""),
            answer["vertices"],
            rays["traced"],
            f"{rays['per_second']:.3g}",
            percent(rays["embree_share"]),
            percent(answer["noise"]["relative"]),
            percent(answer["noise"]["largest"]),
            f"{answer['seconds']['passes']:.2g} s",
        )


def compression(path):
    options = ["--kind", "shadowed", "--local-order", "5", "--clusters", "16,64,256"]
    answer = transfer(path, "compressed", *options)
    full = answer["bytes"]["matrices"]
    print(f"\n{answer['vertices']} matrices in {full} bytes")
    head("clusters", "components", "bytes", "of all", "error", "largest")
    for form in answer["compression"]:
        if form["components"] in (0, 4, 8, 12, 16):
            row(
                form["clusters"],
                form["components"],
                form["bytes"],
                percent(form["bytes"] / full),
                percent(form["relative_l2"]),
                percent(form["largest"]),
            )


def field(path, name):
    """The shape and the numbers of one array of a tensor file."""
    data = path.read_bytes()
    at = 18
    for _ in range(struct.unpack_from("<I", data, 14)[0]):
        (length,) = struct.unpack_from("<H", data, at)
        found = data[at + 2 : at + 2 + length].decode()
        at += 2 + length
        dimensions, _, offset = struct.unpack_from("<HBQ", data, at)
        shape = struct.unpack_from(f"<{dimensions}Q", data, at + 11)
        at += 11 + 8 * dimensions
        if found == name:
            return shape, struct.unpack_from(f"<{math.prod(shape)}f", data, offset)
    raise KeyError(name)


def matrix_noise(path):
    """The distance of matrices by 2,025 rays from those by four times as many."""
    options = ("--kind", "shadowed", "--local-order", "5", "--clusters", "0")
    found = []
    for rays in ("2025", "8100"):
        transfer(path, "noise", *options, "--rays", rays)
        found.append(field(out / "noise" / "transfer.tensor", "shadowed_matrices")[1])
    gap = sum((a - b) ** 2 for a, b in zip(*found)) / sum(b * b for b in found[1])
    print(f"\nmatrices by 2,025 rays differ from those by 8,100 by {percent(math.sqrt(gap))}")


def furnace():
    path = scene("furnace", ["lambert:kd=1"] * 3, 0.3)
    print()
    head("passes", "mean deficit", "above 1e-3", "never lit", "largest of the others", "vertex")
    for passes in (0, 5, 40, 320):
        options = ("--sides", "front", "--passes", str(passes), "--order", "1")
        transfer(path, "furnace", *options)
        tensors = out / "furnace" / "transfer.tensor"
        (count, channels, slots), values = field(tensors, "interreflected")
        deficits = [1 - math.sqrt(4 * math.pi) * values[v * channels * slots] for v in range(count)]
        dark = [v for v in range(count) if passes >= 40 and deficits[v] > 0.999]
        lit = sorted(set(range(count)) - set(dark))
        worst = max(lit, key=lambda v: abs(deficits[v]))
        above = sum(1 for v in lit if abs(deficits[v]) > 1e-3)
        mean = sum(deficits[v] for v in lit) / len(lit)
        row(passes, f"{mean:.2g}", above, len(dark), f"{deficits[worst]:.2g}", worst)


coloured = scene("meshes", ["lambert:kd=.75", "lambert:kd=.7/.2/.15", "lambert:kd=.2/.35/.7"])
speed(coloured)
furnace()
against_paths(coloured, sys.argv[4] if len(sys.argv) > 4 else "512")
compression(coloured)
matrix_noise(coloured)
