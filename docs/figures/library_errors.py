#!/usr/bin/python3
"""library_errors.py PROGRAM TABLES OUT [--divisions N] [--halfway MATERIALS]

The table of docs/library_of_materials.md: the errors of materials that took no part in a library,
over random divisions of the tables of a folder (MERL layout), beside halfway forms. A library is
learned of each table alone, once; those of a division are merged. Prints medians and the share of
new materials at 120 bytes within the error of halfway 8,4,3, by each measure; OUT/errors.json has
every number, so that a second run goes on.
"""
import argparse
import json
import pathlib
import random
import statistics
import subprocess

import numpy

MEASURES = ("mean_log", "log", "relative_l2", "maximum", "flip")
PAIRS = 20000
HALFWAY = ("6,3,2", "8,4,3", "10,5,5")


class Errors:
    """The numbers so far, by a name for each call."""

    def __init__(self, arguments):
        self.program = arguments.program
        self.out = pathlib.Path(arguments.out)
        self.out.mkdir(parents=True, exist_ok=True)
        self.file = self.out / "errors.json"
        self.known = json.loads(self.file.read_text()) if self.file.exists() else {}

    def call(self, *words):
        run = subprocess.run([self.program, *map(str, words), "--json"], capture_output=True,
                             text=True, check=False)
        if run.returncode:
            raise SystemExit(f"{' '.join(map(str, words))}\n{run.stderr}")
        return json.loads(run.stdout)

    def once(self, name, make):
        if name not in self.known:
            self.known[name] = make()
            self.file.write_text(json.dumps(self.known, indent=0))
        return self.known[name]

    def values(self, spec, keep=None):
        """f of a specification at the pairs, [pair][channel]; kept under a name if there is one."""
        path = self.out / (f"{keep}.npy" if keep else "form.npy")
        if keep and path.exists():
            return numpy.load(path)
        rows = self.out / "values.csv"
        self.call("eval", spec, "--pairs", self.pairs(), "-o", rows, "--force")
        values = numpy.loadtxt(rows, delimiter=",", skiprows=1)[:, 6:9]
        numpy.save(path, values)
        return values

    def pairs(self):
        """Pairs of directions uniform on both hemispheres, as a CSV."""
        path = self.out / "pairs.csv"
        if not path.exists():
            drawn = numpy.random.default_rng(7)
            both = []
            for _ in range(2):
                z, phi = 1 - drawn.random(PAIRS), 2 * numpy.pi * drawn.random(PAIRS)
                s = numpy.sqrt(1 - z * z)
                both += [s * numpy.cos(phi), s * numpy.sin(phi), z]
            numpy.savetxt(path, numpy.stack(both, 1), fmt="%.17g", delimiter=",", comments="",
                          header="wi_x,wi_y,wi_z,wo_x,wo_y,wo_z")
        return path

    def measured(self, table, spec, size):
        """The errors of a specification against a table, with the same pairs for every form."""
        f, g = (numpy.maximum(v, 0) for v in (self.values(table, table.stem), self.values(spec)))
        c = numpy.loadtxt(self.pairs(), delimiter=",", skiprows=1, usecols=2)[:, None]
        picture = self.call("compare", table, spec, "--metrics", "nbrdf")["picture"]
        return {"mean_log": float(abs(numpy.log1p(f * c) - numpy.log1p(g * c)).mean()),
                "log": float(abs(numpy.log((g + 1e-3) / (f + 1e-3))).mean()),
                "relative_l2": float((((g - f) * c) ** 2).sum() / ((f * c) ** 2).sum()) ** 0.5,
                "maximum": float(abs((g - f) * c).max()),
                "flip": picture["flip"]["mean"], "bytes": size}

    def shard(self, table):
        path = self.out / f"{table.stem}.library"
        if not path.exists():
            self.call("library", "learn", table, "-o", path)
        return path

    def encoded(self, library, table):
        where = self.out / "one.library"
        answer = self.call("library", "encode", library, table, "-o", where, "--force", "--limit",
                           10)
        return self.measured(table, where, answer["bytes"])

    def halfway(self, table, orders):
        form = self.out / "form.json"
        answer = self.call("project", table, "--form", "halfway", "--halfway", orders,
                           "--precision", "half", "--reciprocal", "-o", form, "--force")
        return self.measured(table, form, answer["representation"]["bytes"])


def medians(rows):
    return {m: statistics.median(r[m] for r in rows) for m in (*MEASURES, "bytes")}


def line(name, row):
    return (f"| {name} | {row['bytes']:.0f} | " +
            " | ".join(f"{row[m]:.3g}" for m in MEASURES) + " |")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("tables")
    parser.add_argument("out")
    parser.add_argument("--divisions", type=int, default=3)
    parser.add_argument("--new", type=int, default=20, help="materials that take no part")
    parser.add_argument("--halfway", type=int, default=60, help="materials with halfway forms")
    arguments = parser.parse_args()
    errors = Errors(arguments)
    tables = sorted(pathlib.Path(arguments.tables).glob("*.binary"))
    print("| form | bytes | mean log | log (1e-3) | relative L2 | maximum | FLIP |")
    print("|---|---|---|---|---|---|---|")
    forms = {}
    some = random.Random(0).sample(tables, min(arguments.halfway, len(tables)))
    for orders in HALFWAY:
        forms[orders] = {t.stem: errors.once(f"halfway {orders} {t.stem}",
                                             lambda t=t, o=orders: errors.halfway(t, o))
                         for t in some}
        print(line(f"halfway {orders}", medians(forms[orders].values())), flush=True)
    within = dict.fromkeys((*MEASURES, "all"), 0)
    count = 0
    for size in (60, 120, 240):
        rows = []
        for division in range(arguments.divisions):
            mixed = tables[:]
            random.Random(division).shuffle(mixed)
            new, old = mixed[:arguments.new], mixed[arguments.new:]
            library = errors.out / f"division-{division}-{size}.library"
            if not library.exists():
                errors.call("library", "merge", *(errors.shard(t) for t in old), "--bytes", size,
                            "-o", library)
            for table in new:
                row = errors.once(f"new {size} {division} {table.stem}",
                                  lambda t=table, l=library: errors.encoded(l, t))
                rows.append(row)
                if size == 120 and table.stem in forms["8,4,3"]:
                    theirs = forms["8,4,3"][table.stem]
                    better = [m for m in MEASURES if row[m] <= theirs[m]]
                    count += 1
                    within["all"] += len(better) == len(MEASURES)
                    for m in better:
                        within[m] += 1
        print(line(f"new material, {size} bytes", medians(rows)), flush=True)
    print(f"\nnew materials at 120 bytes within halfway 8,4,3, of {count}: "
          f"{', '.join(f'{m} {n}' for m, n in within.items())}")


if __name__ == "__main__":
    main()
