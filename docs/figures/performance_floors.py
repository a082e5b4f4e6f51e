"""What the machine can do, and the share of it that bases, projection, analysis and files reach."""
from benchmark_results import BELOW, DASHED, ms, percent, plot, solid, table

ORDERS = (4, 8, 16, 32, 64, 128, 256)
FAMILIES = ("hsh", "sh", "esh", "zernike", "makhotkin", "makhotkin-flux")


def fma_rate(machine, real):
    """Multiply-adds a second of the fastest instruction set, None where it was not measured."""
    rates = [e["items_per_second"] / 2 for name, e in machine.items()
             if name.startswith(f"fma/{real}@")]
    return max(rates, default=None)


def machine(found):
    if not found:
        return {}
    rows = []
    targets = sorted({name.split("@")[1] for name in found if "@" in name},
                     key=lambda t: found[f"fma/double@{t}"]["items_per_second"])
    for target in targets:
        rows.append([f"multiply-adds in registers, {target}"]
                    + [f"{found[f'fma/{real}@{target}']['items_per_second'] / 1e9:.1f}"
                       for real in ("double", "float")])
    for shape in sorted({name.split("/")[2] for name in found if name.startswith("product/")}):
        cells = []
        for real in ("double", "float"):
            rate = found[f"product/{real}/{shape}"]["items_per_second"]
            cells.append(f"{rate / 1e9:.1f} ({percent(rate / 2 / fma_rate(found, real))})")
        rows.append([f"Eigen, {' x '.join(shape.split('x'))}"] + cells)
    sections = {"machine": table(["GFLOP/s", "double", "float"], rows)}
    places = {"first": "first cache", "second": "second cache", "memory": "beyond the last cache"}
    sections["memory"] = table(
        ["GB/s", "memset, written", "copy, read and written", "sum, read"],
        [[title] + [f"{found[f'{what}/{place}']['bytes_per_second'] / 1e9:.1f}"
                    for what in ("memset", "copy", "sum")]
         for place, title in places.items() if f"memset/{place}" in found])
    return sections


def nanoseconds(found):
    """A direction, by name."""
    return {name: 1e9 / e["items_per_second"] for name, e in found.items()
            if "items_per_second" in e}


def basis_kernels(found):
    """All bases at the two orders that the comparisons are for."""
    ns = nanoseconds(found)
    rows = []
    for order in (7, 10):
        if f"gsl/{order}" not in ns:
            continue
        targets = sorted({name.split("@")[1].split("/")[0] for name in ns if "@" in name},
                         key=lambda t: ns[f"sh/double@{t}/{order}"])
        gsl = ns[f"gsl/{order}"]
        for name in FAMILIES:
            double, single = (f"{name}/{real}@{targets[0]}/{order}" for real in ("double", "float"))
            one = ns[f"{name}/one/{order}"]
            rows.append([f"{name}, <= {order - 1}", f"{ns[double]:.1f}",
                         f"{found[double]['error']:.0e}", f"{gsl / ns[double]:.1f}",
                         f"{ns[double] / ns[f'memset/double/{order}']:.2f}", f"{ns[single]:.1f}",
                         f"{found[single]['error']:.0e}", f"{ns[double] / ns[single]:.2f}",
                         f"{one:.0f}", f"{gsl / one:.1f}"])
    if not rows:
        return {}
    return {"basis_kernels": table(
        ["basis, degree", "ns, double", "error", "x GSL", "/ memset", "ns, float", "error",
         "x double", "ns, one a call", "x GSL"], rows)}


def basis_orders(found, rates):
    """Time against order with the shares of both floors, and time against error."""
    ns = nanoseconds(found)
    orders = [n for n in ORDERS if f"hsh/double/{n}" in ns]
    if not orders:
        return {}
    rows = []
    for n in orders:
        row = [n, f"{ns[f'gsl/{n}']:.4g}"]
        for name in ("sh/double", "hsh/double", "sh/float", "hsh/float"):
            row.append(f"{ns[f'{name}/{n}']:.4g}")
        for real in ("double", "float"):
            time = ns[f"hsh/{real}/{n}"]
            row.append(percent(ns[f"memset/{real}/{n}"] / time))
            row.append(percent(2e9 * n * n / rates[real] / time) if rates[real] else "")
        row += [f"{found[f'hsh/{real}/{n}']['error']:.0e}" for real in ("double", "float")]
        rows.append(row)
    curve = lambda name: [(n, ns[f"{name}/{n}"]) for n in orders]
    if rates["double"]:
        count = ("FMA rate, double",
                 [(n, 2e9 * n * n / rates["double"]) for n in orders], DASHED)
    else:
        last = orders[-1]
        count = ("order²",
                 [(n, ns[f"hsh/double/{last}"] * (n / last) ** 2) for n in orders], DASHED)
    plot("basis-order", ("order", "ns, all functions at a direction"),
         [("GSL", curve("gsl"), solid(2)), ("SH, double", curve("sh/double"), solid(0)),
          ("HSH, double", curve("hsh/double"), solid(1)),
          ("SH, float", curve("sh/float"), solid(0, 3)),
          ("HSH, float", curve("hsh/float"), solid(1, 3)), count],
         key=BELOW, extra=["set format y '10^{%L}'"])
    by_error(found, ns, orders)
    return {"basis_orders": table(
        ["order", "GSL, ns", "SH", "HSH", "SH, float", "HSH, float", "of the bandwidth",
         "of the FMA rate", "float: bandwidth", "FMA rate", "error", "float"], rows)}


def by_error(found, ns, orders):
    """Time of a value over its error, a curve from the least order to the largest."""
    titles = (("GSL", "gsl", solid(2)), ("SH, one value at a time", "sh/scalar", solid(3)),
              ("SH, double", "sh/double", solid(0)), ("HSH, double", "hsh/double", solid(1)),
              ("SH, float", "sh/float", solid(0, 3)), ("HSH, float", "hsh/float", solid(1, 3)))
    curves = []
    for title, name, style in titles:
        points = [(found[f"{name}/{n}"]["error"], ns[f"{name}/{n}"] / n**2) for n in orders]
        curves.append((title, points, style))
    plot("basis-error", ("largest error over the largest value", "ns a value"), curves,
         key="top right Left reverse", extra=[
             "unset mxtics", "set xtics 100 format '10^{%L}'", "set xrange [1e-16:1e-4]",
             "set yrange [*:10]", "set ytics format '%g'"])


def projection_floor(found, rates):
    rows = []
    for name in ("ward", "ggx"):
        e = found.get(f"floorShare/{name}")
        if not e:
            continue
        # (2 n - 1) / 4 multiply-adds a value of order 7: each of the azimuth functions has the
        # symmetries of a quadrant.
        least = 13 / 4 / rates["double"] * 1e9 if rates["double"] else None
        every = e["brdf_ns"] + e["rest_ns"]
        rows.append([name, f"{ms(e):.3g}", f"{e['brdf_ns']:.2f}", f"{e['product_ns']:.2f}",
                     f"{least:.2f} ({percent(least / e['product_ns'])})" if least else "",
                     f"{e['rest_ns']:.2f}", percent(e["brdf_share"]),
                     percent((e["brdf_ns"] + least) / every) if least else "",
                     f"{e['over_floor']:.2f}"] + fixed_grid(found, name, ms(e)))
    if not rows:
        return {}
    return {"floor": table(
        ["BRDF", "ms", "BRDF, ns an evaluation", "product alone, ns", "at the FMA rate, ns",
         "all but the BRDF, ns", "share of the BRDF", "BRDF + FMA rate", "all / (BRDF + product)",
         "10,000 points each: BRDF + product, ms", "all / that"],
        rows)}


def fixed_grid(found, name, milliseconds):
    """What the bare evaluations and the product of a fixed grid would take."""
    e = found.get(f"fixedGrid/{name}")
    if not e:
        return ["", ""]
    least = e["brdf_ms"] + e["product_ms"]
    return [f"{e['brdf_ms']:.1f} + {e['product_ms']:.1f}", f"{milliseconds / least:.2f}"]


def brdf_kernels(found):
    """Vectors against double, and both against writing a value."""
    value = {name: 1e6 * ms(e) * e["cpu_time"] / e["real_time"] / (4096 * e["channels"])
             for name, e in found.items() if "channels" in e}
    rows = []
    for name, scalar in value.items():
        spec = name.split("/", 1)[1]
        vectors = value.get(f"vectors/{spec}")
        if not name.startswith("scalar/") or not vectors:
            continue
        entry = found[f"vectors/{spec}"]
        rows.append([f"`{spec}`", f"{entry['channels']:.0f}", f"{scalar:.1f}", f"{vectors:.2f}",
                     f"{scalar / vectors:.1f}", f"{vectors / value['floor/write']:.0f}",
                     f"{entry['difference']:.0e}"])
    if not rows:
        return {}
    return {"brdf_kernels": table(
        ["model", "channels", "double, ns", "vectors, ns", "times as fast", "/ memset",
         "difference"], rows)}


def analysis_operations(degree):
    """Multiply-adds for a function: folded azimuth sums, then theta sums over half of the rings."""
    n, azimuths = degree + 1, (2 * degree + 4) // 4 * 4
    return n * (2 * n - 1) * azimuths / 4 + n * n * ((n + 1) // 2)


def analysis(found, rates):
    points = [(name, e) for name, e in found.items() if name.startswith("againstSharp/")]
    if not points:
        return {}
    rows = []
    for name, e in points:
        _, basis, degree = name.split("/")
        least = (1024 * analysis_operations(int(degree)) / rates["double"]
                 if rates["double"] else None)
        rows.append([basis, degree, f"{ms(e):.3g}", f"{1e3 * e['sharp_seconds']:.3g}",
                     f"{e['ratio']:.2f}", percent(1e3 * least / ms(e)) if least else "",
                     f"{e['error']:.1e}", f"{e['sharp_error']:.1e}"])
    curves = []
    for number, basis in enumerate(("sh", "hsh")):
        own = [(int(n.split("/")[2]), ms(e)) for n, e in points if n.split("/")[1] == basis]
        if own:
            curves.append((f"{basis.upper()}, Analysis", own, solid(number)))
    sharp = [(int(n.split("/")[2]), 1e3 * e["sharp_seconds"])
             for n, e in points if n.split("/")[1] == "sh"]
    curves.append(("SH, libsharp", sharp, solid(2)))
    if rates["double"]:
        curves.append(("FMA rate",
                       [(d, 1e3 * 1024 * analysis_operations(d) / rates["double"])
                        for d, _ in sharp], DASHED))
    plot("analysis", ("degree", "ms, 1024 functions"), curves, key=BELOW)
    return {"analysis": table(
        ["basis", "degree", "ms", "libsharp, ms", "ratio", "of the FMA rate", "error",
         "libsharp, error"], rows)}


def writing(found):
    rows = []
    for name, e in found.items():
        for form in ("json", "exr"):
            rows.append([name.split("/")[1].replace("_", ", "), form.upper(),
                         f"{1e3 * e['projection']:.1f}", f"{1e3 * e[f'{form}_write']:.1f}",
                         f"{e[f'{form}_ratio']:.2f}", f"{1e3 * e[f'{form}_read']:.1f}",
                         f"{e[f'{form}_bytes'] / 1e3:.0f}", f"{e[f'{form}_error']:.0e}"])
    if not rows:
        return {}
    return {"writing": table(
        ["job", "form", "projection, ms", "writing, ms", "writing / projection", "reading, ms",
         "kB", "error read back"], rows)}
