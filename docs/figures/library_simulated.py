#!/usr/bin/python3
"""library_simulated.py PROGRAM LIBRARY OUT COUNT [--shards N,...] [--channels 3]

The cost of a library of very many materials, and whether its bytes depend on shards. COUNT grey
materials are drawn in the terms of libraries: a normal distribution with the mean and covariance
of the channels of LIBRARY (which is not final), the bound of one of these channels. With
--channels 3 they have colours, each channel drawn by itself. They are
written as if `library learn` had projected them, without codes; nothing is read or projected. For
each number of shards: CPU seconds and the largest memory of `library merge`, which learns from
all, and whether the bytes are those of the first.
"""
import argparse
import hashlib
import json
import pathlib
import struct

import numpy

from library_shards import run

TYPES = {1: "u1", 9: "<f2", 10: "<f4"}


def read_tensors(path):
    data = path.read_bytes()
    if not data.startswith(b"tensor_file\0"):
        raise SystemExit(f"{path}: is no tensor file")
    at, fields = 18, {}
    for _ in range(struct.unpack_from("<I", data, 14)[0]):
        length, = struct.unpack_from("<H", data, at)
        name = data[at + 2:at + 2 + length].decode()
        dimensions, kind, offset = struct.unpack_from("<HBQ", data, at + 2 + length)
        at += 2 + length + 11
        shape = struct.unpack_from(f"<{dimensions}Q", data, at)
        at += 8 * dimensions
        fields[name] = numpy.frombuffer(data, TYPES[kind], int(numpy.prod(shape)),
                                        offset).reshape(shape)
    return fields


def write_tensors(path, fields):
    kinds = {"u1": 1, "f2": 9, "f4": 10}
    head = 18 + sum(2 + len(name) + 11 + 8 * array.ndim for name, array in fields.items())
    with open(path, "wb") as file:
        file.write(b"tensor_file\0" + struct.pack("<BBI", 1, 0, len(fields)))
        offset = head
        for name, array in fields.items():
            offset = (offset + 7) // 8 * 8
            file.write(struct.pack("<H", len(name)) + name.encode() +
                       struct.pack("<HBQ", array.ndim, kinds[array.dtype.str[1:]], offset) +
                       struct.pack(f"<{array.ndim}Q", *array.shape))
            offset += array.nbytes
        for array in fields.values():
            file.write(b"\0" * (-file.tell() % 8) + array.tobytes())


def drawn(source, count, channels):
    """Numbers of the channels of `count` materials in all terms, their bounds, and rests."""
    random = numpy.random.default_rng(1)
    rows = source["exponents"].astype(float)
    mean = rows.mean(axis=0)
    _, spreads, axes = numpy.linalg.svd((rows - mean) / numpy.sqrt(len(rows) - 1),
                                        full_matrices=False)
    numbers = mean + random.standard_normal((count * channels, len(spreads))) * spreads @ axes
    chosen = random.integers(len(rows), size=count * channels)
    rests = source["rests"][random.integers(len(source["rests"]), size=count)]
    return (numbers.astype("f4").reshape(count, channels, -1),
            source["tops"][chosen].reshape(count, channels), rests)


def write_shard(path, source, materials, components):
    """materials: those of `drawn` whose numbers are the last."""
    exponents, tops, rests, numbers = materials
    channels = tops.shape[1]
    error = {"mean_log": 0.0, "log": 0.0, "relative_l2": 0.0, "maximum": 0.0, "largest": 1.0,
             "flip": 0.0}
    head = json.loads(source["hshfit_library"].tobytes())
    for key in error:
        error[key] = head["measured"][0]["error"][key]
    widths = source["widths"].astype(int)
    channel = 1 + (int(widths.sum()) + 7) // 8
    names = [f"m{n:06}" for n in numbers]
    head["asked"]["components"] = components
    head["limit"] = {"log": 10.0, "maximum": 10.0, "flip": 10.0}
    head["measured"] = [{"name": name, "source": "drawn", "channels": channels, "error": error}
                        for name in names]
    head["materials"] = [{"name": name, "source": "drawn", "kind": "coded", "channels": channels,
                          "bytes": channels * channel, "error": error} for name in names]
    write_tensors(path, {
        "hshfit_library": numpy.frombuffer(json.dumps(head).encode(), "u1"),
        "mean": source["mean"], "components": source["components"], "widths": source["widths"],
        "codes": numpy.zeros(tops.size * channel, "u1"),
        "exponents": exponents.reshape(tops.size, -1), "tops": tops.ravel(), "rests": rests})


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("library", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("count", type=int)
    parser.add_argument("--shards", default="1,2,8")
    parser.add_argument("--components", type=int, default=20)
    parser.add_argument("--channels", type=int, choices=(1, 3), default=1)
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    source = read_tensors(arguments.library)
    exponents, tops, rests = drawn(source, arguments.count, arguments.channels)
    first = None
    print("| shards | MB of shards | merge, CPU s | a material | MB in use | library, MB | bytes |")
    print("|---|---|---|---|---|---|---|")
    for shards in map(int, arguments.shards.split(",")):
        paths = []
        for k in range(shards):
            numbers = numpy.arange(arguments.count)[k::shards]
            paths.append(arguments.out / f"shard-{k}.library")
            write_shard(paths[-1], source,
                        (exponents[numbers], tops[numbers], rests[numbers], numbers),
                        arguments.components)
        merged = arguments.out / "whole.library"
        cost, memory = run(arguments.program, "library", "merge", *paths, "-o", merged, "--force",
                           "--quiet")
        known = hashlib.sha256(merged.read_bytes()).hexdigest()
        first = first or known
        print(f"| {shards} | {sum(p.stat().st_size for p in paths) / 1e6:.0f} | {cost:.0f} | "
              f"{cost / arguments.count:.4f} | {memory:.0f} | {merged.stat().st_size / 1e6:.0f} | "
              f"{'same' if known == first else 'OTHERS'} |", flush=True)
        for path in paths:
            path.unlink()


if __name__ == "__main__":
    main()
