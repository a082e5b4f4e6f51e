"""Google Benchmark's JSON as tables of Markdown and figures of gnuplot."""
import json
import pathlib
import re
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
UNITS = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}

SOLID = "linespoints lw 2 pt 7 ps 0.6"
DASHED = "lines lw 1 dt 2 lc rgb '#777777'"
BELOW = "bmargin center horizontal Left reverse maxcols 3"
COLOURS = ("#0b62a4", "#d1495b", "#2e8b57", "#e08e0b", "#6b4fa0")


def solid(number, dash=1):
    """The style of curve `number`, always in the same colour."""
    return f"{SOLID} dt {dash} lc rgb '{COLOURS[number]}'"


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


def percent(part):
    return f"{100 * part:.0f} %"


def table(columns, rows):
    lines = [columns, ["---"] * len(columns)] + [[str(c) for c in row] for row in rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def series(found, name):
    """(argument, entry) of a benchmark with one argument."""
    points = [(int(key.split("/")[1]), e) for key, e in found.items()
              if key.startswith(name + "/")]
    return sorted(points, key=lambda point: point[0])


def plot(name, labels, curves, log="xy", key="top left Left reverse", extra=()):
    """Curves are (title, [(x, y)], style); `extra`: gnuplot's commands before the plot."""
    height = 400 if "bmargin" in key else 360
    script = [f"set terminal svg size 560,{height} dynamic font 'sans-serif,12' "
              "background '#ffffff'",
              f"set output '{HERE / f'performance-{name}.svg'}'",
              "set grid lc rgb '#dddddd'", f"set key {key}", "set border 3", "set tics nomirror",
              "set bmargin 7" if "bmargin" in key else "",
              f"set xlabel '{labels[0]}'", f"set ylabel '{labels[1]}'"]
    if log:
        script.append(f"set logscale {log}")
    if "x" in log:
        script.append("set xtics (" + ", ".join(str(x) for x, _ in curves[0][1]) + ")")
        every = [x for _, points, _ in curves for x, _ in points]
        script.append(f"set xrange [{min(every) / 1.3:g}:{max(every) * 1.3:g}]")
    script += extra
    parts, data = [], []
    for title, points, style in curves:
        shown = f"title '{title}'" if title else "notitle"
        parts.append(f"'-' using 1:2 with {style} {shown}")
        data += [f"{x} {y:.6g}" for x, y in points] + ["e"]
    script.append("plot " + ", ".join(parts))
    text = "\n".join(script + data) + "\n"
    subprocess.run(["gnuplot"], input=text, text=True, check=True)
