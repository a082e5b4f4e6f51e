#!/usr/bin/env python3
"""read_transfer.py FOLDER tensor|glb|clusters: facts about the files of hshfit transfer, as JSON,
read by their published layouts alone: the tensor file of RGL, and glTF 2.0."""
import json
import math
import struct
import sys
from pathlib import Path

TYPES = {5: "I", 10: "f"}  # u32 and f32 of the tensor file


def tensors(path):
    data = path.read_bytes()
    assert data[:12] == b"tensor_file\0" and data[12:14] == b"\x01\x00"
    (count,) = struct.unpack_from("<I", data, 14)
    at, fields = 18, {}
    for _ in range(count):
        (length,) = struct.unpack_from("<H", data, at)
        name = data[at + 2 : at + 2 + length].decode()
        at += 2 + length
        dimensions, kind, offset = struct.unpack_from("<HBQ", data, at)
        at += 11
        shape = struct.unpack_from(f"<{dimensions}Q", data, at)
        at += 8 * dimensions
        number = math.prod(shape)
        fields[name] = (shape, struct.unpack_from(f"<{number}{TYPES[kind]}", data, offset))
    return fields


def energy_of(areas, albedos, irradiance):
    """Mean radiance in uniform light; irradiance(v, c) is slot 0 of vertex v and colour c."""
    total = 0
    for v, area in enumerate(areas):
        total += area * sum(albedos[v][c] * irradiance(v, c) for c in range(3)) / 3
    return math.sqrt(4 * math.pi) * total / sum(areas)


def tensor_facts(folder):
    fields = tensors(folder / "transfer.tensor")
    (count, channels, slots), values = fields["interreflected"]
    albedos = fields["albedos"][1]
    mine = [albedos[3 * m : 3 * m + 3] for m in fields["materials"][1]]
    normals, unshadowed = fields["normals"][1], fields["unshadowed"][1]
    worst = 0
    for v in range(count):
        x, y, z = normals[3 * v : 3 * v + 3]
        # Y_00 and Y_1m without the Condon-Shortley sign, times 1 and 2/3.
        a, b = 0.5 / math.sqrt(math.pi), math.sqrt(3 / (4 * math.pi)) * 2 / 3
        for found, expected in zip(unshadowed[v * slots : v * slots + 4], (a, b * y, b * z, b * x)):
            worst = max(worst, abs(found - expected))
    energy = energy_of(
        fields["areas"][1], mine, lambda v, c: values[(v * channels + c % channels) * slots]
    )
    return {
        "vertices": count,
        "channels": channels,
        "energy": energy,
        "unshadowed_error": worst,
    }


def glb_facts(folder):
    data = (folder / "transfer.glb").read_bytes()
    magic, version, length, size, kind = struct.unpack_from("<4sIII4s", data)
    assert magic == b"glTF" and version == 2 and length == len(data) and kind == b"JSON"
    document = json.loads(data[20 : 20 + size])
    binary = data[28 + size :]

    def numbers(index, letter):
        accessor = document["accessors"][index]
        view = document["bufferViews"][accessor["bufferView"]]
        parts = {"SCALAR": 1, "VEC3": 3}[accessor["type"]]
        many = accessor["count"] * parts
        assert view["byteLength"] == 4 * many
        return struct.unpack_from(f"<{many}{letter}", binary, view["byteOffset"]), parts

    primitives = document["meshes"][0]["primitives"]
    places = primitives[0]["attributes"]
    positions = numbers(places["POSITION"], "f")[0]
    first, channels = numbers(places["_TRANSFER_0"], "f")
    count = len(positions) // 3
    areas, albedos, triangles = [0.0] * count, [(0, 0, 0)] * count, 0
    for primitive in primitives:
        colour = document["materials"][primitive["material"]]["pbrMetallicRoughness"]
        indices = numbers(primitive["indices"], "I")[0]
        triangles += len(indices) // 3
        for t in range(0, len(indices), 3):
            a, b, c = (positions[3 * k : 3 * k + 3] for k in indices[t : t + 3])
            u, w = [b[i] - a[i] for i in range(3)], [c[i] - a[i] for i in range(3)]
            across = (
                u[1] * w[2] - u[2] * w[1],
                u[2] * w[0] - u[0] * w[2],
                u[0] * w[1] - u[1] * w[0],
            )
            for k in indices[t : t + 3]:
                areas[k] += math.hypot(*across) / 6
                albedos[k] = colour["baseColorFactor"][:3]
    energy = energy_of(areas, albedos, lambda v, c: first[v * channels + c % channels])
    return {"vertices": count, "triangles": triangles, "energy": energy}


def cluster_facts(folder):
    whole = tensors(folder / "transfer.tensor")["interreflected_matrices"]
    fields = tensors(folder / "clusters.tensor")
    means, components = fields["means"][1], fields["components"][1]
    of, weights = fields["clusters"][1], fields["weights"][1]
    size, number = math.prod(whole[0][1:]), fields["components"][0][1]
    gap = total = 0
    for v, cluster in enumerate(of):
        for i in range(size):
            value = means[cluster * size + i]
            for k in range(number):
                value += weights[v * number + k] * components[(cluster * number + k) * size + i]
            gap += (value - whole[1][v * size + i]) ** 2
            total += whole[1][v * size + i] ** 2
    return {"relative_l2": math.sqrt(gap / total)}


facts = {"tensor": tensor_facts, "glb": glb_facts, "clusters": cluster_facts}
print(json.dumps(facts[sys.argv[2]](Path(sys.argv[1]))))
