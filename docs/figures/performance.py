#!/usr/bin/env python3
"""Tables and figures of docs/results/performance.md from the benchmarks' JSON.

usage: docs/figures/performance.py [FOLDER = out/bench]

Replaces the text between `<!-- NAME -->` and `<!-- /NAME -->` in docs/results/performance.md and
draws
docs/figures/performance-*.svg with gnuplot. Sections whose benchmark was not run stay as they are.
"""
import pathlib
import sys

import performance_floors as floors
from benchmark_results import DASHED, HERE, SOLID, load, ms, plot, series, table

PAGE = HERE.parent / "results" / "performance.md"


def by_order(found):
    points = series(found, "byOrder")
    if not points:
        return {}
    # n rings x 2 n azimuths, times n / 2 products for each value; then n^3 / 2 of theta.
    work = {n: 2.0 * n * n * (n / 2 + 1) + n**3 for n, _ in points}
    last, entry = points[-1]
    curve = [(n, ms(e)) for n, e in points]
    plot("order", ("order", "ms, one outgoing direction"),
         [("projection", curve, SOLID),
          ("operation count, through the last point",
           [(n, ms(entry) * work[n] / work[last]) for n, _ in points], DASHED)], key="bottom right")
    return {"order": table(
        ["order", "evaluations", "ms", "growth", "growth of the operation count"],
        [[n, f"{e['evaluations']:.0f}", f"{ms(e):.3g}",
          f"{ms(e) / ms(points[i - 1][1]):.1f}" if i else "",
          f"{work[n] / work[points[i - 1][0]]:.1f}" if i else ""]
         for i, (n, e) in enumerate(points)])}


def by_directions(found):
    points = series(found, "byDirections")
    if not points:
        return {}
    plot("directions", ("outgoing directions", "ms"),
         [("Ward .2/.5 x cos, order 7", [(n * n, ms(e)) for n, e in points], SOLID)])
    return {"directions": table(
        ["outgoing", "evaluations", "ms", "us a direction", "evaluations a direction"],
        [[f"{n}x{n}", f"{e['evaluations']:.0f}", f"{ms(e):.3g}", f"{1e3 * ms(e) / n**2:.3g}",
          f"{e['evaluations'] / n**2:.0f}"] for n, e in points])}


def by_tolerance(found, carlo):
    points = series(found, "byTolerance")
    if not points:
        return {}
    curves = [("projection, double", [(10.0**-n, ms(e)) for n, e in points], SOLID)]
    monte = next((e for name, e in carlo.items() if name == "monteCarlo/textbook"), None)
    if monte:
        reach = [1e-1, 1e-2, 1e-3]
        curves.append(("textbook Monte Carlo", [
            (error, ms(monte) * (monte["error"] / error) ** 2) for error in reach], DASHED))
    plot("error", ("relative error asked for", "ms, 1024 directions"), curves,
         extra=["unset mxtics", "set format '10^{%L}'", "set xtics 10 format '10^{%L}'"])
    return {"error": table(
        ["tolerance", "evaluations", "ms", "error reported"],
        [[f"1e-{n}", f"{e['evaluations']:.0f}", f"{ms(e):.3g}", f"{e['error']:.1e}"]
         for n, e in points])}


def by_channels_and_bases(found):
    sections = {}
    channels = series(found, "byChannels")
    if channels:
        sections["channels"] = table(
            ["channels", "evaluations", "ms"],
            [[n, f"{e['evaluations']:.0f}", f"{ms(e):.3g}"] for n, e in channels])
    bases = series(found, "byBases")
    if bases:
        first = ms(bases[0][1])
        names = ["hsh", "+ zernike", "+ sh", "+ esh"]
        rows = []
        for i, (n, e) in enumerate(bases):
            more = round(100 * (ms(e) - ms(bases[i - 1][1])) / first) if i else ""
            rows.append([names[n - 1], f"{e['evaluations']:.0f}", f"{ms(e):.3g}", more])
        sections["bases"] = table(["bases", "evaluations", "ms", "more, % of the first"], rows)
    return sections


def monte_carlo(found):
    rows = [[f"{e['tolerance']:.0e}", f"{ms(e) / 1e3:.3g}", f"{e['error']:.1e}",
             f"{e['textbook_ratio_usual']:.3g}", f"{e['textbook_ratio_reached']:.3g}",
             f"1/{1 / e['evaluations_share']:.3g}"]
            for e in found.values() if "textbook_ratio_usual" in e]
    if not rows:
        return {}
    return {"monte_carlo": table(
        ["tolerance", "CPU s", "error reached", "x as fast as 10,000 textbook samples",
         "x as fast at equal error", "evaluations at equal error"], rows)}


def merl(found, projection):
    sections = {}
    rows = [[name.split("/")[1], f"{ms(e):.3g}", f"{e['evaluations']:.0f}", f"{e['error']:.1e}"]
            for name, e in projection.items() if name.startswith("merl/")]
    if rows:
        sections["merl"] = table(["outgoing", "CPU ms, file to coefficients", "evaluations",
                                  "error reported"], rows)
    rows = [[name.split("/")[1], f"{1e3 * e['median_s']:.0f}", f"{1e3 * e['start_s']:.0f}",
             f"{e['peak_mb']:.0f}"] for name, e in found.items() if "median_s" in e]
    if rows:
        sections["merl_program"] = table(
            ["job", "CPU ms, file to file", "of it starting the program", "peak MB"], rows)
    return sections


def folder_of_ten(found):
    rows = [[f"{e['one_thread_s']:.2f}", f"{e['speedup']:.2f}",
             f"{e['speedup_least']:.2f} to {e['speedup_most']:.2f}"]
            for e in found.values() if "speedup" in e]
    if not rows:
        return {}
    return {"folder": table(["one thread, s", "two threads, times as fast", "over five runs"],
                            rows)}


def main():
    folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "out/bench")
    projection = load(folder, "projection")
    carlo = load(folder, "projection_vs_monte_carlo")
    machine = load(folder, "machine")
    rates = {real: floors.fma_rate(machine, real) for real in ("double", "float")}
    kernels = load(folder, "basis_kernels")
    sections = {}
    for part in (floors.machine(machine), floors.basis_kernels(kernels),
                 floors.basis_orders(kernels, rates), floors.projection_floor(projection, rates),
                 floors.brdf_kernels(load(folder, "brdf_kernels")),
                 floors.analysis(load(folder, "analysis"), rates),
                 floors.writing(load(folder, "writing")), by_order(projection),
                 by_directions(projection), by_tolerance(projection, carlo),
                 by_channels_and_bases(projection), monte_carlo(carlo),
                 merl(load(folder, "merl_projection"), projection),
                 folder_of_ten(load(folder, "folder"))):
        sections.update(part)
    if not sections:
        sys.exit(f"performance.py: no benchmark output in {folder}; ./run bench writes it")
    page = PAGE.read_text(encoding="utf-8")
    for name, text in sections.items():
        begin, end = f"<!-- {name} -->", f"<!-- /{name} -->"
        if begin not in page or end not in page:
            sys.exit(f"performance.py: {PAGE.name} has no section {begin} … {end}")
        before, rest = page.split(begin, 1)
        page = before + begin + "\n" + text + "\n" + end + rest.split(end, 1)[1]
    PAGE.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
