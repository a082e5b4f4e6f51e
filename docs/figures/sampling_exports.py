#!/usr/bin/python3
"""The table of docs/explanation/sampling.md: proposals of exports.

    docs/figures/sampling_exports.py build/hshfit FILE.json…

For each coefficient file, as `export` states them: the variance of the weight over the square of
its mean at 0, 30, 60, 75 and 85 degrees, the largest weight over the mean and the largest share of
wasted samples; the variance of the cosine by as many samples; the time of the fit and these
numbers.
"""

import json
import os
import subprocess
import sys
import tempfile


def row(cells):
    return "| " + " | ".join(cells) + " |"


def answer(arguments):
    return json.loads(subprocess.run(arguments + ["--json"], check=True, capture_output=True,
                                     text=True).stdout)


def main(program, paths):
    print(row(["file", "variance", "largest", "wasted", "variance of the cosine, 0 to 60",
               "seconds"]))
    print("|" + "---|" * 6)
    with tempfile.TemporaryDirectory() as folder:
        for path in paths:
            proposal = answer([program, "export", path, "-o", folder, "--name", "x", "--force",
                               "--quiet", "--target", "bin,glsl", "--no-error"])["proposal"]
            at = proposal["efficiency"]
            cosine = [answer([program, "sample", path, "--method", "cosine", "--count", "0",
                              "--elevations", "0", "--trials", "4096", "--outgoing",
                              f"{each['theta']:.0f},45"])["efficiency"]["variance"]
                      for each in at[:3]]
            print(row([f"`{os.path.basename(path)}`",
                       ", ".join(f"{each['variance']:.2g}" for each in at),
                       f"{max(each['largest'] for each in at):.2g}",
                       f"{100 * max(each['wasted'] for each in at):.2g} %",
                       ", ".join(f"{each:.2g}" for each in cosine),
                       f"{proposal['seconds']:.2g}"]), flush=True)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2:])
