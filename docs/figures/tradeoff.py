#!/usr/bin/env python3
"""Prints the tables of docs/results/published_forms.md:
docs/figures/tradeoff.py PROGRAM SHARED TABLE [--paper] [NAME ...]

PROGRAM is build/hshfit, SHARED the folder of shared test data, TABLE one of rgl, merl, models,
slices; NAMEs restrict it to these materials. --paper adds the form of Gautron et al. (2004), which
takes a minute or more of a material. The networks of Sztrajman et al. (2021) are evaluated
here, on the pairs of directions on which the program measures.
"""
import array
import csv
import json
import math
import operator
import pathlib
import subprocess
import sys
import tempfile

# The forms tried for each material: few enough for a minute.
SWEEP = ("--forms outgoing,halfway --bases hsh --orders 3,5,7 --ranks 0,2 "
         "--precisions float32,half,unorm16,unorm8 --tolerance 1e-2 --no-timing").split()
ISOTROPIC = "--outgoing 8".split()
ANISOTROPIC = "--orders 3,5,7 --outgoing 8x8 --outgoing 16x16 --ranks 0".split()
# The size of Gautron et al. (2004): 32 x 32 directions, order 10; 1.2 MB in RGB.
PAPER = ("--forms outgoing --bases hsh --orders 10 --outgoing 32x32 --ranks 0 --split none "
         "--precisions float32 --tolerance 1e-2 --no-timing").split()
BUDGETS = (2700, 4096)
# From glossy to matte.
MERL = ("chrome-steel", "brass", "black-obsidian", "specular-maroon-phenolic", "red-plastic",
        "blue-metallic-paint", "gold-paint", "delrin", "pink-jasper", "white-diffuse-bball",
        "green-latex", "red-fabric")
# One of each model of the catalog, from matte to glossy.
MODELS = ("lambert:kd=.5", "oren-nayar:sigma=30", "eon:roughness=.5", "openpbr-diffuse",
          "minnaert:k=1.5", "charlie:r=.3", "disney:roughness=.5", "phong:exponent=20,kd=.3,ks=.3",
          "blinn-phong:exponent=40,kd=.3,ks=.3", "lafortune:exponent=20,ks=.3,kd=.3",
          "sg:sharpness=30", "ward:ax=.15,ay=.15,kd=.3,ks=.3", "ward:ax=.2,ay=.5",
          "ashikhmin-shirley:nu=30,nv=30", "cook-torrance:m=.3,ior=1.5",
          "he:sigma=.15,tau=3", "abc:B=100,C=1", "sgd:alpha=.1,kd=.3", "beckmann:alpha=.3",
          "ggx:alpha=.3", "ggx:alpha=.1", "ggx:alpha=.02", "gtr:gamma=1.5,alpha=.2",
          "gltf-pbr:baseColorFactor=.8/.5/.2,metallicFactor=.5,roughnessFactor=.5",
          "openpbr:base_color=.5,specular_roughness=.4,coat_weight=.5,coat_roughness=.3",
          "abg:A=.001,B=.01,g=2", "harvey-shack:b0=3,l=.1,s=-2", "ross-li:iso=.3,vol=.1,geo=.03",
          "rpv:rho0=.2,k=.8", "hapke:w=.8")
# The pairs of `tradeoff` are of reflections.
TRANSMISSIONS = {"lambert-transmission", "rough-glass"}


def run(program, *arguments):
    done = subprocess.run([program, *arguments], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, arguments))}: {done.stderr.strip()}")
    return done.stdout


class Network:
    """6-21-21-3 with max(0, x), then exp - 1: inputs are the half and the difference vector with
    the half vector turned to azimuth 0 (Rusinkiewicz 1998)."""

    def __init__(self, shared, family, name):
        folder = shared / "data" / "nbrdf"
        names = (folder / f"{family}_nbrdf_names.txt").read_text(encoding="utf-8").split()
        weights = array.array("f")
        weights.frombytes((folder / f"{family}_nbrdf_weights.f32").read_bytes())
        at = names.index(name) * 675
        self.layers = []
        for rows, columns in ((6, 21), (21, 21), (21, 3)):
            matrix = weights[at:at + rows * columns]
            bias = weights[at + rows * columns:at + rows * columns + columns]
            self.layers.append([(matrix[c::columns], bias[c]) for c in range(columns)])
            at += rows * columns + columns

    def __call__(self, wi, wo):
        values = half_and_difference(wi, wo)
        for k, layer in enumerate(self.layers):
            values = [sum(map(operator.mul, column, values)) + bias for column, bias in layer]
            values = [max(v, 0) if k < 2 else max(math.exp(v) - 1, 0) for v in values]
        return values


def half_and_difference(wi, wo):
    h = [a + b for a, b in zip(wi, wo)]
    length = math.hypot(*h)
    h = [v / length for v in h]
    sine = math.hypot(h[0], h[1])
    c, s = (h[0] / sine, h[1] / sine) if sine > 0 else (1, 0)
    x, y = c * wi[0] + s * wi[1], c * wi[1] - s * wi[0]
    return [sine, 0, h[2], h[2] * x - sine * wi[2], y, sine * x + h[2] * wi[2]]


class Errors:
    """Means of |ln(1 + f c) - ln(1 + g c)| and the largest |f - g| c of a network on the pairs that
    the program wrote: over all, within 10 degrees of the horizon, and with the half vector within 5
    degrees of the normal, as `hshfit tradeoff` divides them."""

    def __init__(self, network, pairs):
        totals, weights, self.maximum = [0.0] * 3, [0.0] * 3, 0.0
        with open(pairs, encoding="utf-8", newline="") as file:
            rows = csv.reader(file)
            next(rows)
            for row in rows:
                v = list(map(float, row))
                f, cosine, weight = v[7:], v[2], v[6]
                g = network(v[0:3], v[3:6])
                error = sum(abs(math.log1p(a * cosine) - math.log1p(b * cosine))
                            for a, b in zip(f, g)) / len(f)
                self.maximum = max(self.maximum, *(abs(a - b) * cosine for a, b in zip(f, g)))
                h = [v[i] + v[i + 3] for i in range(3)]
                zones = (True, min(v[2], v[5]) < math.sin(math.radians(10)),
                         h[2] > math.cos(math.radians(5)) * math.hypot(*h))
                for zone in range(3):
                    totals[zone] += weight * error * zones[zone]
                    weights[zone] += weight * zones[zone]
        self.mean, self.horizon, self.mirror = (
            total / weight if weight > 0 else math.nan for total, weight in zip(totals, weights))


def best(forms, budget):
    within = [form for form in forms if form["bytes"] <= budget and form["error"] is not None]
    return min(within, key=lambda form: (form["error"], form["bytes"])) if within else None


def cell(form):
    return f"{form['error']:.4f} ({form['bytes']} B)" if form else "–"


def measure(program, spec, paper, *more):
    """The trade of one BRDF, and the error of the paper's form if asked for."""
    trade = json.loads(run(program, "tradeoff", spec, "--json", *SWEEP, *more))["tradeoffs"][0]
    if not paper:
        return trade, None
    at = more.index("--pairs") if "--pairs" in more else len(more)
    answer = json.loads(run(program, "tradeoff", spec, "--json", *PAPER, *more[at:at + 2]))
    return trade, answer["tradeoffs"][0]["forms"][0]["error"]


def row(name, trade, paper, network):
    forms = trade["forms"]
    knee = forms[trade["knee"]]
    small = best(forms, 4096)
    beside = [f"{error:.4f}" for error in (paper, network and network.mean) if error is not None]
    cells = [cell(best(forms, budget)) for budget in BUDGETS]
    return ["| " + " | ".join([name, *beside, cell(knee), *cells]) + " |",
            f"{name}: knee `{knee['options']}`; within 4 KiB `{small['options']}`"]


def number(value):
    return "" if value is None or math.isnan(value) else f"{value:.2g}"


def zones(name, trade, network):
    """The best form within 2700 bytes beside the network, where means hide most."""
    form = best(trade["forms"], 2700)
    pairs = form["pairs"]
    ours = [pairs[zone]["value"] for zone in ("horizon", "mirror", "maximum")]
    theirs = [network.horizon, network.mirror, network.maximum]
    cells = [f"{number(b)}, {number(a)}" for a, b in zip(ours, theirs)]
    most = pairs["maximum"]
    cells[-1] += f" at {most['wi']['theta']:.0f}°, {most['wo']['theta']:.0f}°"
    mean = f"{form['error']:.4f} ± {pairs['mean_log']['error']:.1g}"
    # Of pairs in a plane there is none.
    own = pairs["albedo"]
    albedo = ""
    if own["of"]:
        first, last = own["theta_o"]
        albedo = f"{number(own['value'])} of {number(own['of'])} at {first:.4g} to {last:.4g}°"
    return "| " + " | ".join([name, mean, *cells, albedo]) + " |"


ZONES = """
Within 2700 bytes: error of our form; network, ours near the horizon, near the mirror, largest
|f - g| c, with theta of wi and wo where ours is; our largest error of albedo, with theta of wo

| material | mean | horizon | mirror | maximum | albedo |
|---|---|---|---|---|---|"""


def heading(paper, network):
    beside = ["HSH 32x32 order 10, 1.2 MB"] if paper else []
    beside += ["network, 2.7 KB"] if network else []
    columns = ["material", *beside, "knee of the front",
               *[f"best within {budget} B" for budget in BUDGETS]]
    return f"| {' | '.join(columns)} |\n|{'---|' * len(columns)}"


def rgl(program, shared, folder):
    for path in sorted((shared / "data" / "rgl").glob("*_rgb.bsdf")):
        yield path.stem.removesuffix("_rgb"), str(path), [], ("rgl-isotropic", path.stem)


def merl(program, shared, folder):
    for name in MERL:
        path = folder / f"{name}.binary"
        yield name, str(path), [], ("merl", name)


def make_merl(shared, path):
    tool = shared / "tools" / "merl_hybrid.py"
    subprocess.run(["/usr/bin/python3", tool, path.stem, path], check=True, capture_output=True)


def slices(program, shared, folder):
    plane = folder / "plane.csv"
    write_plane(plane)
    for name in MERL:
        path = shared / "data" / "merl_slices" / f"{name}.slice"
        yield name, str(path), ["--pairs", str(plane)], ("merl", name)


def write_plane(path):
    """Pairs with phi_d = 90 degrees at the nodes of the slices, weighed with
    d omega_i d omega_o = 4 cos(theta_d) d omega_h d omega_d."""
    lines = ["wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,weight"]
    for i in range(1, 90):
        half = (i / 90) ** 2 * math.pi / 2
        width = ((i + 0.5) ** 2 - (i - 0.5) ** 2) / 8100
        for j in range(1, 90):
            difference = j / 90 * math.pi / 2
            s, c = math.sin(difference), math.cos(difference)
            x, z = math.sin(half) * c, math.cos(half) * c
            weight = math.sin(half) * width * s * c
            lines.append(f"{x!r},{s!r},{z!r},{x!r},{-s!r},{z!r},{weight!r}")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def models(program, shared, folder):
    listed = {m["name"] for m in json.loads(run(program, "list", "models", "--json"))["models"]}
    shown = {spec.split(":")[0] for spec in MODELS}
    if listed - TRANSMISSIONS != shown:
        sys.exit(f"MODELS lacks {listed - TRANSMISSIONS - shown}, has {shown - listed} too many")
    for spec in MODELS:
        laws = json.loads(run(program, "info", spec, "--json"))["laws"]
        yield f"`{spec}`", spec, [] if laws["isotropic"] else ANISOTROPIC, None


def main():
    if len(sys.argv) < 4 or sys.argv[3] not in TABLES:
        sys.exit(__doc__)
    program, shared, table = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3]
    paper = "--paper" in sys.argv
    chosen = [word for word in sys.argv[4:] if word != "--paper"]
    print(heading(paper, table != "models"), flush=True)
    notes, beyond = [], []
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        for name, spec, more, network in TABLES[table](program, shared, folder):
            if chosen and name.strip("`") not in chosen:
                continue
            if table == "merl":
                make_merl(shared, pathlib.Path(spec))
            pairs = folder / "pairs.csv"
            sets = [] if more[:1] == ["--orders"] else ISOTROPIC
            trade, beside = measure(program, spec, paper, *sets, *more, "--force",
                                    "--write-pairs", str(pairs))
            error = Errors(Network(shared, *network), pairs) if network else None
            line, note = row(name, trade, beside, error)
            print(line, flush=True)
            notes.append(note)
            if error and "pairs" in trade["forms"][0]:
                beyond.append(zones(name, trade, error))
            if table == "merl":
                pathlib.Path(spec).unlink()
    if beyond:
        print(ZONES + "\n" + "\n".join(beyond))
    print("\n" + "\n".join(notes))


TABLES = {"rgl": rgl, "merl": merl, "models": models, "slices": slices}

if __name__ == "__main__":
    main()
