#!/usr/bin/python3
"""The table of docs/sampling.md: proposals of exports.

    docs/figures/sampling_exports.py build/hshfit FILE.json…

For each coefficient file the albedo (mean of the channels), the variance of the weight over the
square of its mean, the largest weight over the mean and the share of wasted samples, by elevation of
the outgoing direction, as `export` states them, and the time that they took.
"""

import json
import os
import subprocess
import sys
import tempfile


def row(cells):
    return "| " + " | ".join(cells) + " |"


def main(program, paths):
    print(row(["file", "theta_o", "albedo", "variance", "largest", "wasted", "cosine's variance"]))
    print("|" + "---|" * 7)
    seconds = []
    with tempfile.TemporaryDirectory() as folder:
        for path in paths:
            text = subprocess.run(
                [program, "export", path, "-o", folder, "--name", "x", "--force", "--quiet",
                 "--target", "bin,glsl", "--no-error", "--json"],
                check=True, capture_output=True, text=True).stdout
            proposal = json.loads(text)["proposal"]
            seconds.append(proposal["seconds"])
            for number, at in enumerate(proposal["efficiency"]):
                values = at["albedo"] or at["estimate"]
                cosine = json.loads(subprocess.run(
                    [program, "sample", path, "--method", "cosine", "--count", "0", "--elevations",
                     "0", "--trials", "4096", "--outgoing", f"{at['theta']:.0f},45", "--json"],
                    check=True, capture_output=True, text=True).stdout)["efficiency"]
                print(row(["" if number else f"`{os.path.basename(path)}`", f"{at['theta']:.0f}",
                           f"{sum(values) / len(values):.3f}{'' if at['albedo'] else ' +-'}",
                           f"{at['variance']:.2g}", f"{at['largest']:.3g}",
                           f"{100 * at['wasted']:.2g} %", f"{cosine['variance']:.2g}"]))
    print(f"seconds: {min(seconds):.2g} to {max(seconds):.2g}")


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2:])
