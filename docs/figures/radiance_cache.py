#!/usr/bin/env python3
"""radiance_cache.py PROGRAM MESHES FOLDER [spacing|costs|floor]: figures of
docs/results/illumination.md.

Measures `illuminate --method radiance-cache` against path tracing in the Cornell box, whose meshes
lie in MESHES (cbox_*.obj), without direct light. Scenes, pictures and tables.md go to FOLDER. Takes
about a quarter of an hour of CPU.

With `spacing` only the table of error control, with `floor` only that of the parts of the error,
both at 128 x 128; with `costs` only that of predicted costs, in another folder.

Errors are relative mean squares, as relative_mse of the answer, against two references of other
seeds at once: the mean of (T - A)(T - B) / (R^2 + (m / 10)^2), R = (A + B) / 2, which the noise of
the references leaves without bias.
"""
import json
import os
import struct
import subprocess
import sys
import zlib
from pathlib import Path

from exr_pixels import read_exr

PROGRAM, MESHES, FOLDER = (Path(word).resolve() for word in sys.argv[1:4])

# Reflectances and radiance as in the scene of Mitsuba 3 that the meshes come with.
WHITE = ".885809/.698859/.666422"
MATERIALS = {
    "white": f"lambert:kd={WHITE}",
    "red": "lambert:kd=.570068/.0430135/.0443706",
    "green": "lambert:kd=.105421/.37798/.076425",
    "box": "lambert:kd=.45/.30/.90",
    "light": "lambert:kd=.936461/.740433/.705267",
    "glossy": "phong:kd=.2,ks=.6,exponent=22,normalized=true",
}
OBJECTS = {"floor": "white", "ceiling": "white", "back": "glossy", "redwall": "red",
           "greenwall": "green", "smallbox": "box", "largebox": "box", "luminaire": "light"}
# Mitsuba's +y is up; (x, y, z) becomes (x, -z, y).
VIEWS = {"centre": (278, 800), "left": (478, 780), "right": (78, 780)}


def write_scene(size):
    objects = []
    for name, material in OBJECTS.items():
        mesh = os.path.relpath(MESHES / f"cbox_{name}.obj", FOLDER)
        objects.append({"name": name, "mesh": mesh, "up": "y", "material": material})
    objects[-1].update(emission=[18.387, 13.9873, 6.75357], at=[0, 0, -0.5])
    cameras = [{"name": name, "position": [x, y, 273], "target": [278, -280, 273],
                "field_of_view": 39.3077, "width": size, "height": size}
               for name, (x, y) in VIEWS.items()]
    scene = {"format": "hshfit-scene", "version": 1,
             "materials": [{"name": n, "brdf": b} for n, b in MATERIALS.items()],
             "objects": objects, "cameras": cameras}
    path = FOLDER / f"box{size}.json"
    path.write_text(json.dumps(scene, indent=1))
    return path


def run(name, scene, *options, keep=False):
    """The answer of `illuminate`, whose pictures go to FOLDER/name; an earlier one if `keep`."""
    answer = FOLDER / f"{name}.json"
    if keep and answer.exists():
        return json.loads(answer.read_text())
    command = [str(PROGRAM), "illuminate", str(scene), "-o", str(FOLDER / name), "--from-bounce",
               "2", "--force", "--json", *map(str, options)]
    answer.write_bytes(subprocess.run(command, check=True, capture_output=True).stdout)
    return json.loads(answer.read_text())


def cpu_of(answer):
    return answer.get("cache_cpu_seconds", 0) + sum(c["cpu_seconds"] for c in answer["cameras"])


def error_terms(test, references):
    """The terms of the error, as pairs of a pixel and a number."""
    first, second = references
    count = len(test["R"])
    mean = sum(sum(first[c]) + sum(second[c]) for c in "RGB") / (6 * count)
    for c in "RGB":
        for k, (t, a, b) in enumerate(zip(test[c], first[c], second[c])):
            yield k, (t - a) * (t - b) / ((a + b) ** 2 / 4 + mean ** 2 / 100)


def error_of(test, references, mask=None):
    """Of a picture, or of those pixels of it that are set in the mask."""
    terms = [term for k, term in error_terms(test, references) if not mask or mask[k]]
    return sum(terms) / len(terms)


class References:
    """Two of each view, and the pixels of the back wall."""

    samples = 400

    def __init__(self, size):
        self.scene = write_scene(size)
        runs = [run(f"reference{seed}", self.scene, "--samples", self.samples, "--seed", seed,
                    keep=True)
                for seed in (11, 12)]
        self.seconds = sum(cpu_of(answer) for answer in runs) / len(runs) / self.samples
        self.pictures = {view: [read_exr(FOLDER / f"reference{seed}" / f"{view}.exr")
                                for seed in (11, 12)] for view in VIEWS}
        scene = json.loads(self.scene.read_text())
        for thing in scene["objects"]:
            thing["emission"] = 1 if thing["name"] == "back" else 0
        path = FOLDER / "wall.json"
        path.write_text(json.dumps(scene))
        subprocess.run([str(PROGRAM), "illuminate", str(path), "-o", str(FOLDER / "wall"),
                        "--force", "--bounces", "0", "--samples", "16"], check=True,
                       capture_output=True)
        self.wall = {view: [x > 0.999 for x in read_exr(FOLDER / "wall" / f"{view}.exr")["R"]]
                     for view in VIEWS}

    def errors(self, name):
        """Over the views: whole pictures, and the back wall alone."""
        whole = wall = 0
        for view in VIEWS:
            picture = read_exr(FOLDER / name / f"{view}.exr")
            whole += error_of(picture, self.pictures[view]) / len(VIEWS)
            wall += error_of(picture, self.pictures[view], self.wall[view]) / len(VIEWS)
        return whole, wall

    def largest(self, name, size, block=8):
        """Of the errors of squares of 8 x 8 pixels, with view, column and row of the square. In
        single pixels the noise of the references prevails."""
        found = (0, "", 0, 0)
        for view in VIEWS:
            picture = read_exr(FOLDER / name / f"{view}.exr")
            sums = {}
            for k, term in error_terms(picture, self.pictures[view]):
                place = (k % size // block, k // size // block)
                sums[place] = sums.get(place, 0) + term / (3 * block * block)
            place = max(sums, key=sums.get)
            found = max(found, (sums[place], view, place[0] * block, place[1] * block))
        return found


def read_png(path):
    data, at, packed = path.read_bytes(), 8, b""
    while at < len(data):
        size, = struct.unpack_from(">I", data, at)
        kind, body = data[at + 4:at + 8], data[at + 8:at + 8 + size]
        at += 12 + size
        if kind == b"IHDR":
            width, height, _, colour = struct.unpack(">IIBB", body[:10])
        if kind == b"IDAT":
            packed += body
    channels = 4 if colour == 6 else 3
    raw, rows, before = zlib.decompress(packed), [], bytearray(width * channels)
    for y in range(height):
        begin = y * (width * channels + 1)
        line = bytearray(raw[begin + 1:begin + 1 + width * channels])
        for x in range(len(line)):
            a = line[x - channels] if x >= channels else 0
            b, c = before[x], before[x - channels] if x >= channels else 0
            kind = raw[begin]
            if kind == 3:
                add = (a + b) // 2
            elif kind == 4:
                add = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
            else:
                add = (0, a, b)[kind]
            line[x] = (line[x] + add) & 255
        rows.append([line[k::channels] for k in range(3)])
        before = line
    return rows


def write_png(path, rows):
    def chunk(kind, body):
        check = struct.pack(">I", zlib.crc32(kind + body))
        return struct.pack(">I", len(body)) + kind + body + check
    head = struct.pack(">IIBBBBB", len(rows[0]) // 3, len(rows), 8, 2, 0, 0, 0)
    body = zlib.compress(b"".join(b"\0" + row for row in rows), 9)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", body) +
                     chunk(b"IEND", b""))


def beside(path, names, factor):
    """PNG pictures side by side, each pixel the mean of factor x factor."""
    pictures = [read_png(name) for name in names]
    rows = []
    for y in range(len(pictures[0]) // factor):
        row = bytearray()
        for picture in pictures:
            block = picture[y * factor:(y + 1) * factor]
            for x in range(len(block[0][0]) // factor):
                for k in range(3):
                    total = sum(sum(line[k][x * factor:(x + 1) * factor]) for line in block)
                    row.append(total // factor ** 2)
        rows.append(bytes(row))
    write_png(path, rows)


def figure_9(out):
    answer = run("fig9", write_scene(850), "--method", "radiance-cache", "--order", 10, "--rays",
                 4000)
    out.append("| view | records | new | MB | s | CPU s | the paper's new records | its s |")
    out.append("|---|---|---|---|---|---|---|---|")
    for camera, records, seconds in zip(answer["cameras"], (1121, 250, 198), (25.8, 11.2, 10.3)):
        out.append(f"| {camera['camera']} | {camera['records']} | {camera['new_records']} | "
                   f"{camera['bytes'] / 1e6:.2f} | {camera['seconds']:.1f} | "
                   f"{camera['cpu_seconds']:.1f} | {records} | {seconds} |")
    out.append(f"Before the first view: {answer['cache_cpu_seconds']:.1f} CPU s.")
    views = ("left", "centre", "right")
    beside(FOLDER / "radiance_cache.png", [FOLDER / "fig9" / f"{v}.png" for v in views], 4)
    beside(FOLDER / "radiance_cache_records.png",
           [FOLDER / "fig9" / f"{v}.records.png" for v in views], 4)


SETTINGS = [(250, .5), (500, .4), (1000, .3), (4000, .2)]


def draw(points, path_unit):
    """Error against CPU time, as an SVG file by gnuplot."""
    commands = ["set terminal svg size 640,420 font 'sans,13' background 'white'",
                f"set output '{FOLDER / 'radiance_cache_error.svg'}'", "set logscale xy",
                "set xlabel 'CPU seconds, three views of 256 x 256'",
                "set ylabel 'relative mean square error'", "set grid", "set format y '%.0e'",
                "set xrange [5:2000]"]
    for label, values in points.items():
        lines = "\n".join(f"{x} {y}" for x, y in values)
        commands.append(f"${label} << EOD\n{lines}\nEOD")
    commands.append(
        f"plot {path_unit} / x title 'path tracing' lc rgb '#0072b2' lw 2, "
        "$cache with linespoints title 'radiance cache' lc rgb '#d55e00' lw 2 pt 7, "
        "$published with linespoints title 'as published in 2004' lc rgb '#009e73' lw 2 pt 5")
    subprocess.run(["gnuplot"], input="\n".join(commands), text=True, check=True)


def curves(out):
    size = 256
    references = References(size)
    path = run("path", references.scene, "--samples", 64)
    whole, wall = references.errors("path")
    units = {"whole": whole * cpu_of(path), "wall": wall * cpu_of(path)}
    out.append(f"Path tracing, 64 samples: {cpu_of(path):.1f} CPU s, {whole:.3e}, wall {wall:.3e}; "
               f"error times CPU s {units['whole']:.3f}, wall {units['wall']:.3f}.")
    out.append("")
    out.append("| rays, a | records | CPU s, three views | error | path tracing, CPU s | ratio | "
               "wall: error | ratio | largest of 8 x 8 pixels |")
    out.append("|---|---|---|---|---|---|---|---|---|")

    def measure(label, *options):
        answer = run("cache", references.scene, "--method", "radiance-cache", "--samples", 64,
                     *options)
        cpu, records = cpu_of(answer), answer["cameras"][-1]["records"]
        whole, wall = references.errors("cache")
        path_whole, path_wall = units["whole"] / whole, units["wall"] / wall
        out.append(f"| {label} | {records} | {cpu:.1f} | {whole:.2e} | {path_whole:.0f} | "
                   f"{path_whole / cpu:.0f} | {wall:.2e} | {path_wall / cpu:.0f} | "
                   "{:.2g} at {} ({}, {}) |".format(*references.largest("cache", size)))
        print(out[-1], flush=True)
        return cpu, whole

    points = {"cache": [], "published": []}
    for rays, accuracy in SETTINGS:
        setting = ["--rays", rays, "--accuracy", accuracy]
        points["cache"].append(measure(f"{rays}, {accuracy}", *setting))
        points["published"].append(
            measure(f"{rays}, {accuracy}, as published", *setting, "--published"))
    draw(points, units["whole"])
    terms = {"all": [], "gradient by hit points": ["--gradient", "hit-points"],
             "no gradient": ["--gradient", "none"]}
    # Gradients limit the spacing only where errors do not.
    for term in ("neighbour-clamping", "error-control", "error-control,gradient-limit"):
        terms[f"without {term}"] = ["--without", term]
    terms["as published"] = ["--published"]
    for label, options in terms.items():
        measure(label, "--rays", 1000, "--accuracy", 0.4, *options)


def spacing(out):
    """Error against records with and without error control, means over two seeds."""
    references = References(128)
    out.append("| error control | a | records | CPU s | error | wall: error |")
    out.append("|---|---|---|---|---|---|")
    ways = {"second derivatives": [], "none": ["--without", "error-control"]}
    for label, options in ways.items():
        for accuracy in (.2, .3, .4, .5):
            records = cpu = whole = wall = 0
            for seed in (1, 2):
                answer = run("cache", references.scene, "--method", "radiance-cache", "--rays",
                             2000, "--accuracy", accuracy, "--seed", seed, *options)
                errors = references.errors("cache")
                records += answer["cameras"][-1]["records"] / 2
                cpu += cpu_of(answer) / 2
                whole += errors[0] / 2
                wall += errors[1] / 2
            out.append(f"| {label} | {accuracy} | {records:.0f} | {cpu:.1f} | {whole:.2e} | "
                       f"{wall:.2e} |")
            print(out[-1], flush=True)


def floor(out):
    """The error of many records and rays, and of one thing better at a time."""
    references = References(128)
    out.append("| setting | records | CPU s | error | wall: error |")
    out.append("|---|---|---|---|---|")
    more = ([], ["--surface-points", 32768], ["--surface-rays", 1024],
            ["--loss", 0.0005, "--order", 16], ["--least-reach", 0.005], ["--accuracy", 0.1])
    for options in more:
        answer = run("cache", references.scene, "--method", "radiance-cache", "--rays", 4000,
                     *([] if "--accuracy" in options else ["--accuracy", 0.2]), *options)
        whole, wall = references.errors("cache")
        label = " ".join(map(str, options)) or "a = 0.2"
        out.append(f"| {label} | {answer['cameras'][-1]['records']} | {cpu_of(answer):.1f} | "
                   f"{whole:.2e} | {wall:.2e} |")
        print(out[-1], flush=True)


def close_scene(name):
    """A picture of the glossy wall alone, or of a glossy ball in its place."""
    scene = json.loads(write_scene(96).read_text())
    camera = scene["cameras"][0]
    camera.update(field_of_view=7, target=[278, -280, 366])
    if name == "ball":
        camera.update(field_of_view=11, target=[278, -280, 200])
        scene["objects"] = [thing for thing in scene["objects"] if "box" not in thing["name"]]
        for thing in scene["objects"]:
            thing["material"] = thing["material"].replace("glossy", "white")
        scene["objects"].append({"name": name, "mesh": "sphere", "material": "glossy",
                                 "scale": 150, "at": [278, -280, 200]})
    scene["cameras"] = [camera]
    path = FOLDER / f"{name}.json"
    path.write_text(json.dumps(scene))
    return path


def costs(out):
    """Predicted against measured costs of records and of sampling, at equal error."""
    out.append("| scene | | predicted | measured |")
    out.append("|---|---|---|---|")
    for name in ("wall", "ball"):
        path = close_scene(name)
        for seed in (11, 12):
            run(f"{name}{seed}", path, "--samples", 400, "--seed", seed, keep=True)
        references = [read_exr(FOLDER / f"{name}{seed}" / "centre.exr") for seed in (11, 12)]

        def measured(*options):
            answer = run("cache", path, "--method", "radiance-cache", *options)
            return answer, error_of(read_exr(FOLDER / "cache" / "centre.exr"), references)

        by_records, error = measured("--choose-by", "loss")
        predicted = next(m["predicted"] for m in by_records["materials"] if "predicted" in m)
        cache, sampling = predicted["cache"], predicted["sampling"]
        camera = by_records["cameras"][0]
        sampled, other = measured("--loss", 0, "--samples", 16 * sampling["walks"])
        for what, left, right in (
                ("records", f"{cache['records']:.0f}", camera["records"]),
                ("CPU s by records", f"{cache['cpu_seconds']:.2f}",
                 f"{camera['cpu_seconds']:.2f}"),
                ("error by records", f"{predicted['error']:.1e}", f"{error:.1e}"),
                (f"CPU s by sampling, {sampling['walks']} walks",
                 f"{sampling['cpu_seconds']:.1f}", f"{sampled['cameras'][0]['cpu_seconds']:.1f}"),
                ("error by sampling", f"{predicted['error']:.1e}", f"{other:.1e}")):
            out.append(f"| {name} | {what} | {left} | {right} |")
            print(out[-1], flush=True)


def main():
    FOLDER.mkdir(parents=True, exist_ok=True)
    out = []
    if sys.argv[4:]:
        {"spacing": spacing, "costs": costs, "floor": floor}[sys.argv[4]](out)
        (FOLDER / "tables.md").write_text("\n".join(out) + "\n")
        return
    figure_9(out)
    print("\n".join(out), flush=True)
    curves(out)
    (FOLDER / "tables.md").write_text("\n".join(out) + "\n")


main()
