#!/usr/bin/env python3
"""svbrdf_scale.py FOLDER [--side 4096] [--runs 3]: what docs/explanation/svbrdf_scale.md quotes
of the program.

FOLDER has hshfit and hshfit-mpi. Maps of ggx (kd, ks and alpha, 8 bits, waves with noise) are made
here. Prints a line for each form of a map; the rates of one and of two processes with one thread
each, in turns; and the estimate for 16,384 x 16,384 texels on 64 machines. Time is the processor's
unless it says otherwise: other programs may run beside it.
"""
import argparse
import json
import multiprocessing
import os
import statistics
import struct
import subprocess
import sys
import tempfile
import time
import zlib
from pathlib import Path

import numpy

FORMS = (["outgoing"], ["low-rank"], ["clusters", "--clusters", "256"])


def png(path, values):
    """An 8-bit picture of one channel or of three."""
    height, width = values.shape[:2]
    rows = numpy.zeros((height, 1 + values.size // height), numpy.uint8)
    rows[:, 1:] = numpy.round(values * 255).reshape(height, -1)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(
            ">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, 8, 2 if values.ndim == 3 else 0, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head)
                     + chunk(b"IDAT", zlib.compress(rows.tobytes(), 1)) + chunk(b"IEND", b""))


def pfm(path, values):
    """The same as floats, of which any rows can be read."""
    height, width = values.shape[:2]
    head = f"{'PF' if values.ndim == 3 else 'Pf'}\n{width} {height}\n-1.0\n"
    path.write_bytes(head.encode() + values[::-1].astype("<f4").tobytes())


def make_maps(folder, side):
    """Maps of a size, in both formats."""
    def write(name, values):
        png(folder / f"{name}.png", values)
        pfm(folder / f"{name}.pfm", values)

    random = numpy.random.default_rng(1)
    y, x = numpy.mgrid[0:side, 0:side] / side

    def noisy(wave, noise):
        return numpy.clip(wave + random.normal(0, noise, (side, side)), 0, 1)

    colour = [noisy(0.4 + 0.3 * numpy.sin(9 * x + k) * numpy.cos(7 * y), 0.05) for k in range(3)]
    write("kd", 0.8 * numpy.stack(colour, -1))
    write("ks", 0.6 * noisy(0.3 + 0.2 * numpy.sin(5 * x * y), 0.03))
    write("alpha",
          0.1 + 0.8 * noisy(0.4 + 0.3 * numpy.sin(11 * y) * numpy.cos(13 * x), 0.05))


def describe(folder, side, kind):
    """The description of materials with maps of a size. A process of its own makes them: the peak
    memory of a parent counts as its child's."""
    maps = multiprocessing.Process(target=make_maps, args=(folder, side))
    maps.start()
    maps.join()
    parameters = {name: {"map": f"{name}.{kind}"} for name in ("kd", "ks", "alpha")}
    path = folder / f"d{side}.json"
    path.write_text(json.dumps({"format": "hshfit-svbrdf", "version": 1, "model": "ggx",
                                "parameters": parameters}))
    return path


def run(command):
    """The answer of the program, the processor time and the peak memory of its largest process."""
    with tempfile.TemporaryFile() as out:
        child = subprocess.Popen(command, stdout=out, stderr=subprocess.DEVNULL)
        _, status, used = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode != 0:
            sys.exit(f"svbrdf_scale: {' '.join(map(str, command))}: {child.returncode}")
        out.seek(0)
        return json.load(out), used.ru_utime + used.ru_stime, used.ru_maxrss / 2**20


def percent(error):
    return f"{100 * error['mean']:.2g} % / {100 * error['maximum']:.2g} %"


def forms(program, folder, side):
    """Bytes, errors, time and memory of each form."""
    description = describe(folder, side, "png")
    for form in FORMS:
        answer, seconds, memory = run([program, "svbrdf", description, "-o", folder / "out",
                                       "--force", "--json", "--form", *form])
        texels = answer["width"] * answer["height"]
        errors = [percent(level["error"]) for level in answer["levels"][:7]]
        print(f"{' '.join(form)} ({answer['count']}): {answer['bytes'] / texels:.4g} bytes a texel "
              f"of level 0, processor {seconds:.1f} s, wall {answer['seconds']['preparation']:.1f}"
              f" + {answer['seconds']['writing']:.1f} s, {memory:.2f} GiB; errors by level "
              f"{', '.join(errors)}", flush=True)
    for choice in answer["choices"]:
        print(f"  {choice['form']} {choice['count']}: {choice['bytes_per_texel']:g} bytes, shared "
              f"{choice['shared_bytes']}, {percent(choice['error'])}")


def ranks(program, folder, side, runs, kind):
    """One and two processes, each on a processor of its own, in turns."""
    description = describe(folder, side, kind)
    environment = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    os.environ.update(environment)
    for form in FORMS:
        ratios, wholes, times = [], [], {1: [], 2: []}
        for _ in range(runs):
            walls, parts = {}, {}
            for count in (1, 2):
                answer, seconds, _ = run(
                    ["mpirun", "--bind-to", "core", "-n", str(count), f"{program}-mpi", "svbrdf",
                     description, "-o", folder / "out", "--force", "--json", "--threads", "1",
                     "--checks", "0", "--form", *form])
                walls[count] = answer["seconds"]["writing"]
                parts[count] = sum(answer["seconds"].values())
                times[count].append(seconds)
            ratios.append(walls[1] / walls[2])
            wholes.append(parts[1] / parts[2])
        print(f"{kind}, {form[0]}: two processes over one, writing {statistics.median(ratios):.2f} "
              f"({min(ratios):.2f} to {max(ratios):.2f}), whole {statistics.median(wholes):.2f} "
              f"({min(wholes):.2f} to {max(wholes):.2f}); processor "
              f"{statistics.median(times[1]):.2f} s and {statistics.median(times[2]):.2f} s",
              flush=True)


def make_normals(folder, side):
    """Bumps of every texel, and lengths of 1."""
    slopes = 0.3 * numpy.random.default_rng(2).normal(size=(side, side, 2))
    vectors = numpy.concatenate([slopes, numpy.ones((side, side, 1))], -1)
    pfm(folder / "n.pfm", vectors / numpy.linalg.norm(vectors, axis=-1, keepdims=True))


def turned(program, folder, runs, sides):
    """One and two processes for the forms of turned texels, likewise; the whole by the clock."""
    os.environ.update({"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"})
    description = folder / "turned.json"
    description.write_text(json.dumps({
        "format": "hshfit-svbrdf", "version": 1, "model": "ggx", "normal": {"map": "n.pfm"},
        "parameters": {"alpha": 0.2, "kd": [0.3, 0.2, 0.1], "F0": 0.5}}))
    for side, form in zip(sides, (["harmonics", "--harmonics", "33", "--checks", "0"],
                                  ["ellipse", "--checks", "0"], ["filtered"])):
        make_normals(folder, side)
        writing, wholes, times = [], [], {1: [], 2: []}
        for _ in range(runs):
            walls, parts = {}, {}
            for count in (1, 2):
                start = time.monotonic()
                answer, _, _ = run(
                    ["mpirun", "--bind-to", "core", "-n", str(count), f"{program}-mpi", "svbrdf",
                     description, "-o", folder / "out", "--force", "--json", "--threads", "1",
                     "--form", *form])
                parts[count] = time.monotonic() - start
                walls[count] = answer["seconds"]
                times[count].append(parts[count])
            writing.append(walls[1] / walls[2])
            wholes.append(parts[1] / parts[2])
        print(f"{side} x {side}, {form[0]}: two processes over one, writing "
              f"{statistics.median(writing):.2f} ({min(writing):.2f} to {max(writing):.2f}), whole "
              f"{statistics.median(wholes):.2f} ({min(wholes):.2f} to {max(wholes):.2f}); "
              f"{statistics.median(times[1]):.2f} s and {statistics.median(times[2]):.2f} s, "
              f"{answer['bytes'] / 1e6:.0f} MB", flush=True)


def estimate(texel_seconds, decode_seconds, disk):
    """16,384 x 16,384 texels on 64 machines of 32 processors, from measured times."""
    texels, machines, processors = 16384**2, 64, 32
    size = texels * 512 * 4 / 3
    compute = texels * texel_seconds / (machines * processors)
    decode = 2 * texels * decode_seconds  # for the check and the texels
    write = size / (machines * disk)
    print(f"estimate: {size / 1e9:.0f} GB; computing {compute:.2f} s; writing at "
          f"{disk / 1e9:.1f} GB/s a machine {write:.2f} s; decoding the maps twice "
          f"{decode / machines:.1f} s by rows, {decode:.1f} s of PNG")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--side", type=int, default=4096)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--only", choices=("forms", "ranks", "turned", "estimate"))
    parser.add_argument("--texel-ns", type=float, default=227, help="processor time of a texel")
    parser.add_argument("--decode-ns", type=float, default=96, help="of decoding a texel's maps")
    parser.add_argument("--disk", type=float, default=3e9, help="bytes a second of a machine")
    given = parser.parse_args()
    program = given.folder.resolve() / "hshfit"
    with tempfile.TemporaryDirectory() as name:
        if given.only in (None, "forms"):
            forms(program, Path(name), given.side)
        if given.only in (None, "ranks"):
            for kind in ("pfm", "png"):
                ranks(program, Path(name), 2048, given.runs, kind)
        if given.only in (None, "turned"):
            turned(program, Path(name), given.runs, (1024, 2048, 512))
    if given.only in (None, "estimate"):
        estimate(given.texel_ns * 1e-9, given.decode_ns * 1e-9, given.disk)


if __name__ == "__main__":
    main()
