#!/usr/bin/env python3
"""Tables and figures of docs/performance.md from the benchmarks' JSON.

usage: docs/figures/performance.py [FOLDER = out/bench]

Replaces what stands between `<!-- NAME -->` and `<!-- /NAME -->` in docs/performance.md and draws
docs/figures/performance-*.svg with gnuplot. Sections whose benchmark was not run stay as they are.
"""
import json
import pathlib
import re
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
PAGE = HERE.parent / "performance.md"
UNITS = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}


def load(folder, program):
    """Benchmarks by name; of repetitions, the median."""
    path = folder / f"{program}.json"
    if not path.exists():
        return {}
    found = {}
    for entry in json.loads(path.read_text(encoding="utf-8"))["benchmarks"]:
        if entry.get("error_occurred"):
            print(f"{program}: {entry['name']}: {entry['error_message']}", file=sys.stderr)
            continue
        name = entry.get("run_name", entry["name"])
        aggregate = entry.get("aggregate_name")
        if aggregate == "median" or (aggregate is None and name not in found):
            found[name] = entry
    return {re.sub(r"/(manual_time|iterations:\d+|repeats:\d+)", "", name): e
            for name, e in found.items()}


def ms(entry):
    return entry["real_time"] * UNITS[entry["time_unit"]] * 1e3


def table(columns, rows):
    lines = [columns, ["---"] * len(columns)] + [[str(c) for c in row] for row in rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def series(found, name):
    """(argument, entry) of a benchmark with one argument."""
    points = [(int(key.split("/")[1]), e) for key, e in found.items()
              if key.startswith(name + "/")]
    return sorted(points, key=lambda point: point[0])


def plot(name, labels, curves, log="xy", key="top left"):
    """Curves are (title, [(x, y)], style) with gnuplot styles."""
    script = [f"set terminal svg size 560,360 dynamic font 'sans-serif,12' background '#ffffff'",
              f"set output '{HERE / f'performance-{name}.svg'}'",
              "set grid lc rgb '#dddddd'", f"set key {key}", "set border 3", "set tics nomirror",
              f"set xlabel '{labels[0]}'", f"set ylabel '{labels[1]}'"]
    if log:
        script.append(f"set logscale {log}")
    if "x" in log:
        script.append("set xtics (" + ", ".join(str(x) for x, _ in curves[0][1]) + ")")
    parts, data = [], []
    for title, points, style in curves:
        parts.append(f"'-' using 1:2 with {style} title '{title}'")
        data += [f"{x} {y:.6g}" for x, y in points] + ["e"]
    script.append("plot " + ", ".join(parts))
    text = "\n".join(script + data) + "\n"
    subprocess.run(["gnuplot"], input=text, text=True, check=True)


SOLID = "linespoints lw 2 pt 7 ps 0.6"
DASHED = "lines lw 1 dt 2 lc rgb '#777777'"


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
            (error, 1e0 * ms(monte) * (monte["error"] / error) ** 2) for error in reach], DASHED))
    plot("error", ("relative error asked for", "ms, 1024 directions"), curves, key="center right")
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
        plot("channels", ("channels", "ms"),
             [("GGX .3 x cos, 1024 directions", [(n, ms(e)) for n, e in channels], SOLID)], log="")
    bases = series(found, "byBases")
    if bases:
        first = ms(bases[0][1])
        names = ["hsh", "+ zernike", "+ sh", "+ esh"]
        rows = []
        for i, (n, e) in enumerate(bases):
            more = f"{100 * (ms(e) - ms(bases[i - 1][1])) / first:.1f} %" if i else ""
            rows.append([names[n - 1], f"{e['evaluations']:.0f}", f"{ms(e):.3g}", more])
        sections["bases"] = table(["bases", "evaluations", "ms", "more, of the first"], rows)
    return sections


def by_threads(found):
    points = series(found, "byThreads")
    if not points:
        return {}
    plot("threads", ("threads", "ms of wall time"),
         [("Ward .2/.5 x cos, 1024 directions", [(n, ms(e)) for n, e in points], SOLID)])
    return {"threads": table(
        ["threads", "ms, wall", "speed"],
        [[n, f"{ms(e):.3g}", f"{ms(points[0][1]) / ms(e):.2f}"] for n, e in points])}


def floor(found):
    rows = []
    for name in ("ward", "ggx"):
        e = found.get(f"floorShare/{name}")
        if e:
            rows.append([name, f"{ms(e):.3g}", f"{e['brdf_ns']:.2f}", f"{e['product_ns']:.2f}",
                         f"{e['rest_ns']:.2f}", f"{100 * e['brdf_share']:.0f} %",
                         f"{e['over_floor']:.2f}"])
    if not rows:
        return {}
    return {"floor": table(
        ["BRDF", "ms", "BRDF, ns an evaluation", "product alone, ns", "all but the BRDF, ns",
         "share of the BRDF", "all / (BRDF + product)"], rows)}


def analysis(found):
    points = [(name, e) for name, e in found.items() if name.startswith("againstSharp/")]
    if not points:
        return {}
    rows = []
    for name, e in points:
        _, basis, degree = name.split("/")
        rows.append([basis, degree, f"{ms(e):.3g}", f"{1e3 * e['sharp_seconds']:.3g}",
                     f"{e['ratio']:.2f}", f"{e['error']:.1e}", f"{e['sharp_error']:.1e}"])
    curves = []
    for basis in ("sh", "hsh"):
        own = [(int(n.split("/")[2]), ms(e)) for n, e in points if n.split("/")[1] == basis]
        if own:
            curves.append((f"{basis}, Analysis", own, SOLID))
    curves.append(("sh, libsharp", [(int(n.split("/")[2]), 1e3 * e["sharp_seconds"])
                                    for n, e in points if n.split("/")[1] == "sh"], DASHED))
    plot("analysis", ("degree", "ms, 1024 functions"), curves)
    return {"analysis": table(["basis", "degree", "ms", "libsharp, ms", "ratio", "error",
                               "libsharp, error"], rows)}


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
    sections = {}
    for part in (by_order(projection), by_directions(projection),
                 by_tolerance(projection, carlo), by_channels_and_bases(projection),
                 by_threads(projection), floor(projection), analysis(load(folder, "analysis")),
                 monte_carlo(carlo), merl(load(folder, "merl_projection"), projection),
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
