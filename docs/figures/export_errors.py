#!/usr/bin/python3
"""The table of docs/reference/export.md: errors of exported representations, split into their
causes.

    docs/figures/export_errors.py build/hshfit SPEC…
"""

import json
import os
import subprocess
import sys
import tempfile

COLUMNS = ("material", "map", "number", "bytes", "truncation", "interpolation", "storage",
           "total", "mean log")


def row(cells):
    return "| " + " | ".join(cells) + " |"


def exported(program, folder, number):
    command = [program, "export", folder + "/c.json", "-o", folder + "/out", "--force", "--quiet",
               "--json", "--target", "bin", "--number", number]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def cells(spec, answer):
    error = answer["fit_error"]
    causes = ("truncation", "interpolation", "quantisation", "total")
    return (["`%s`" % os.path.basename(spec), answer["outgoing"], answer["number"],
             str(answer["texel_bytes"])] + ["%.3g %%" % (100 * error[c]) for c in causes] +
            ["%.3g" % error["mean_log"]])


def main(program, specs):
    print(row(COLUMNS))
    print("|" + "---|" * len(COLUMNS))
    with tempfile.TemporaryDirectory() as folder:
        for spec in specs:
            for outgoing in ("32x32", "64x64"):
                subprocess.run([program, "project", spec, "--rgb", "--quiet", "--order", "7",
                                "--outgoing", outgoing, "--force", "-o", folder + "/c.json"],
                               check=True, stdout=subprocess.DEVNULL)
                for number in ("float16", "unorm8"):
                    print(row(cells(spec, exported(program, folder, number))), flush=True)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
