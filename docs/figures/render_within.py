#!/usr/bin/env python3
"""Pictures by coefficients at the order that `report` says is enough for 1 %, against direct
integration: twelve materials under five lights (docs/reference/render.md).

    docs/figures/render_within.py [--program build/hshfit] [--shared ../shared] [--size 32]
        [--tolerance 1e-3] [SPEC…]

Enough: the root of the share of the energy of f cos(theta_i) that the order misses is at most 1 %,
a captured energy of 0.9999, over the outgoing directions that `render` uses. Each row of the table
has the difference of the picture in per cent under each light: relative L2, and in brackets the
largest of a pixel over the mean radiance. A row ends with the remarks of `render`.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

MATERIALS = [
    "lambert:kd=.5",
    "oren-nayar:sigma=30",
    "minnaert:k=1.5",
    "eon:roughness=.8",
    "phong:exponent=5",
    "phong:exponent=22,ks=.5,kd=.2",
    "lafortune:exponent=12",
    "sg:sharpness=20",
    "ggx:alpha=.8",
    "charlie:r=.5",
    "blinn-phong:exponent=20",
    "phong:exponent=100",
]
LIGHTS = {
    "uniform": "uniform",
    "sky": "sky:type=12,elevation=40",
    "sun": "sun:elevation=40,azimuth=20",
    "panel": "panel:elevation=50,azimuth=-40,width=60,height=20",
    "room": "{shared}/data/env/rnl_probe_latlong.hdr",
}
ENOUGH = 0.9999


def answer(program, *words):
    done = subprocess.run([program, *words, "--json"], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(words)}: {done.stderr}")
    return json.loads(done.stdout), [line for line in done.stderr.splitlines() if line]


def enough(program, material):
    """The least order of hsh that misses at most 1 % of f cos(theta_i)."""
    report, _ = answer(program, "report", material, "--bases", "hsh", "--max-order", "48",
                       "--outgoing", "64", "--cosine")
    points = report["reports"][0]["curves"][0]["points"]
    return next(p["order"] for p in points if p["accuracy"] >= ENOUGH)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="build/hshfit")
    parser.add_argument("--shared", default="../shared")
    parser.add_argument("--size", default="32")
    parser.add_argument("--tolerance", default="1e-3")
    parser.add_argument("materials", nargs="*", default=MATERIALS)
    arguments = parser.parse_args()
    print("| material | order |", " | ".join(LIGHTS), "| remarks |")
    print("|---" * (len(LIGHTS) + 3) + "|")
    worst, sum_of_all, count = (0, ""), 0, 0
    with tempfile.TemporaryDirectory() as folder:
        output = str(pathlib.Path(folder) / "a.exr")
        for material in arguments.materials:
            order, cells, remarks = enough(arguments.program, material), [], 0
            for name, light in LIGHTS.items():
                rendered, lines = answer(
                    arguments.program, "render", material, "--cosine", "--order", str(order),
                    "--light", light.format(shared=arguments.shared), "--size", arguments.size,
                    "--samples", "1", "--tolerance", arguments.tolerance, "--force", "-o", output)
                picture = rendered["pictures"][1]
                l2, largest = 100 * picture["relative_l2"], 100 * picture["maximum"]
                cells.append(f"{l2:.2f} ({largest:.1f})")
                remarks += len(lines)
                worst = max(worst, (l2, f"{material} under {name}"))
                sum_of_all, count = sum_of_all + l2, count + 1
            print(f"| `{material}` | {order} |", " | ".join(cells), f"| {remarks or ''} |",
                  flush=True)
    print(f"\nrelative L2: mean {sum_of_all / count:.2f} %, largest {worst[0]:.2f} %: {worst[1]}")


if __name__ == "__main__":
    main()
