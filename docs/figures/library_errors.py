#!/usr/bin/python3
"""library_errors.py PROGRAM TABLES OUT [--divisions N] [--halfway MATERIALS] [--few]

The table of docs/results/libraries.md: the errors of materials that took no part
in a library, over random divisions of the tables or planes of a folder (MERL layout), beside
halfway forms. A library is learned of each table alone, once; those of a division are merged.
Prints medians and the share of new materials at 120 bytes within the error of halfway 8,4,3, by
each measure; OUT/errors.json has every number, so that a second run goes on. --few: instead,
materials from 5, 10 and 20 directions with errors of 2 %, chosen by `library next`, at random, and
chosen in the plane of incidence, beside fits to the same samples with each loss, and the share of
the truth within bands of one deviation.
"""
import argparse
import json
import pathlib
import random
import statistics
import subprocess

import numpy

MEASURES = ("mean_log", "log", "relative_l2", "maximum", "flip")
PAIRS = 12000
FREE = ("--limit", 10, "--limit-maximum", 10, "--limit-flip", 1)  # no material falls back
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

    def measured(self, table, spec, size, picture):
        """The errors of a specification against a table, with the same pairs for every form."""
        f, g = (numpy.maximum(v, 0) for v in (self.values(table, table.stem), self.values(spec)))
        c = numpy.loadtxt(self.pairs(), delimiter=",", skiprows=1, usecols=2)[:, None]
        return {"mean_log": float(abs(numpy.log1p(f * c) - numpy.log1p(g * c)).mean()),
                "log": float(abs(numpy.log((g + 1e-3) / (f + 1e-3))).mean()),
                "relative_l2": float((((g - f) * c) ** 2).sum() / ((f * c) ** 2).sum()) ** 0.5,
                "maximum": float(abs((g - f) * c).max()),
                "flip": picture["flip"]["mean"], "bytes": size}

    def shard(self, table):
        path = self.out / f"{table.stem}.library"
        if not path.exists():
            self.call("library", "learn", table, *FREE, "-o", path)
        return path

    def division(self, tables, division, new, size):
        """A library of a random part of the tables, and the others."""
        mixed = tables[:]
        random.Random(division).shuffle(mixed)
        library = self.out / f"division-{division}-{size}.library"
        if not library.exists():
            self.call("library", "merge", *(self.shard(t) for t in mixed[new:]), "--bytes", size,
                      "-o", library)
        return library, mixed[:new]

    def encoded(self, library, table):
        where = self.out / "one.library"
        answer = self.call("library", "encode", library, table, "-o", where, "--force", *FREE)
        return self.measured(table, where, answer["bytes"], answer["picture"])

    def halfway(self, table, orders):
        form = self.out / "form.json"
        answer = self.call("project", table, "--form", "halfway", "--halfway", orders,
                           "--precision", "half", "--reciprocal", "-o", form, "--force")
        return self.measured(table, form, answer["representation"]["bytes"], answer["picture"])


def medians(rows):
    return {m: statistics.median(r[m] for r in rows) for m in (*MEASURES, "bytes")}


def line(name, row):
    return (f"| {name} | {row['bytes']:.0f} | " +
            " | ".join(f"{row[m]:.3g}" for m in MEASURES) + " |")


KINDS = ("chosen", "random", "in-plane")
LOSSES = ("log", "log-relative", "cube-root", "cosine", "l2")  # of a fit of lambert+ggx


def directions(errors, library, kind, count):
    """Pairs of directions to measure, [pair][theta_i, phi_i, theta_o, phi_o] in degrees."""
    if kind == "random":
        drawn = numpy.random.default_rng(count)
        theta = numpy.degrees(numpy.arccos(1 - drawn.random((count, 2)) * (1 - numpy.cos(1.4))))
        return numpy.stack([theta[:, 0], 0 * theta[:, 0], theta[:, 1],
                            360 * drawn.random(count)], 1)
    where = errors.out / "next.csv"
    instrument = "in-plane" if kind == "in-plane" else "free"
    errors.call("library", "next", "--library", library, "--count", count, "--instrument",
                instrument, "-o", where, "--force")
    return numpy.loadtxt(where, delimiter=",", skiprows=1, ndmin=2)[:, :4]


def vectors(angles):
    theta, phi = numpy.radians(angles[:, 0]), numpy.radians(angles[:, 1])
    return numpy.stack([numpy.sin(theta) * numpy.cos(phi), numpy.sin(theta) * numpy.sin(phi),
                        numpy.cos(theta)], 1)


def scan(errors, table, pairs, seed):
    """A CSV of samples of a table with errors of 2 %."""
    where, values = errors.out / "scan-pairs.csv", errors.out / "scan-values.csv"
    numpy.savetxt(where, numpy.hstack([vectors(pairs[:, :2]), vectors(pairs[:, 2:])]), fmt="%.17g",
                  delimiter=",", comments="", header="wi_x,wi_y,wi_z,wo_x,wo_y,wo_z")
    errors.call("eval", table, "--pairs", where, "-o", values, "--force")
    f = numpy.loadtxt(values, delimiter=",", skiprows=1, ndmin=2)[:, 6:9]
    f = f * (1 + 0.02 * numpy.random.default_rng(seed).standard_normal(f.shape))
    samples = errors.out / "samples.csv"
    numpy.savetxt(samples, numpy.hstack([pairs, f]), fmt="%.9g", delimiter=",", comments="",
                  header="theta_i,phi_i,theta_o,phi_o,R,G,B")
    return samples


def covered(bands, f):
    """The share of values of f within the bands; rows of a band: angles, then value, low, high."""
    rows = numpy.loadtxt(bands, delimiter=",", skiprows=1)
    low, high = rows[:, 5::3], rows[:, 6::3]
    return float(((f >= low) & (f <= high)).mean())


def pointwise(errors, f, spec):
    """The mean log error of a specification at the pairs."""
    c = numpy.loadtxt(errors.pairs(), delimiter=",", skiprows=1, usecols=2)[:, None]
    g = numpy.maximum(errors.values(spec), 0)
    return float(abs(numpy.log1p(numpy.maximum(f, 0) * c) - numpy.log1p(g * c)).mean())


def one_scan(errors, library, table, pairs, seed):
    samples, form = scan(errors, table, pairs, seed), errors.out / "found.library"
    bands = errors.out / "bands.csv"
    answer = errors.call("library", "reconstruct", samples, "--library", library, "-o", form,
                         "--bands", errors.pairs(), "--bands-to", bands, "--force")
    f = errors.values(table, table.stem)
    return {"library": pointwise(errors, f, form), "covered": covered(bands, f),
            "known": answer["known"]}


def one_fit(errors, table, pairs, seed, loss):
    """The mean log error of a fit to the same samples; None where there is no fit."""
    samples, fit = scan(errors, table, pairs, seed), errors.out / "fit.json"
    run = subprocess.run([errors.program, "fit", samples, "--model", "lambert+ggx", "--loss", loss,
                          "-o", fit, "--force", "--quiet"], capture_output=True, check=False)
    return pointwise(errors, errors.values(table, table.stem), fit) if not run.returncode else None


def few(errors, tables, arguments):
    print("| directions | library, mean log | bands | unknown | " + " | ".join(LOSSES) + " |")
    print("|---|---|---|---|" + "---|" * len(LOSSES))
    for kind in KINDS:
        for count in (5, 10, 20):
            rows, fits = [], {loss: [] for loss in LOSSES}
            for division in range(arguments.divisions):
                library, new = errors.division(tables, division, arguments.new, 120)
                pairs = directions(errors, library, kind, count)
                for seed, table in enumerate(new):
                    name = f"{kind} {count} {division} {table.stem}"
                    rows.append(errors.once(f"few {name}", lambda t=table, s=seed:
                                            one_scan(errors, library, t, pairs, s)))
                    for loss in LOSSES:
                        fits[loss].append(errors.once(f"fit {loss} {name}", lambda t=table, s=seed:
                                                      one_fit(errors, t, pairs, s, loss)))
            print(f"| {count} {kind} | {statistics.median(r['library'] for r in rows):.2g} | "
                  f"{statistics.mean(r['covered'] for r in rows):.2f} | "
                  f"{sum(not r['known'] for r in rows)} of {len(rows)} | " +
                  " | ".join(f"{statistics.median([v for v in fits[loss] if v] or [0]):.2g}"
                             for loss in LOSSES) + " |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("tables")
    parser.add_argument("out")
    parser.add_argument("--divisions", type=int, default=3)
    parser.add_argument("--new", type=int, default=20, help="materials that take no part")
    parser.add_argument("--halfway", type=int, default=60, help="materials with halfway forms")
    parser.add_argument("--others", type=int, default=3, help="divisions at 60 and 240 bytes")
    parser.add_argument("--few", action="store_true", help="materials from few directions")
    arguments = parser.parse_args()
    errors = Errors(arguments)
    tables = sorted(p for p in pathlib.Path(arguments.tables).iterdir()
                    if p.suffix in (".binary", ".slice"))
    if arguments.few:
        return few(errors, tables, arguments)
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
        for division in range(arguments.divisions if size == 120 else
                              min(arguments.divisions, arguments.others)):
            library, new = errors.division(tables, division, arguments.new, size)
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
