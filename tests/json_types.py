#!/usr/bin/env python3
"""json_types.py PROGRAM [--kinds N] [--seed S] [--only INPUT]: JSON of wrong types is refused.

Makes an example of every JSON file that PROGRAM reads, and runs PROGRAM once for each value of it
(the first and the last of long lists) and each of N other values in its place: null, true, -1,
1e300, a text, lists and objects. Each run has to

- end with 0, 2, 3 or 4 within 20 s of CPU and 2 GiB;
- name the file on standard error where it fails, without "internal error".

Breaches are printed; ends with 1 if there is one.
"""
import argparse
import base64
import copy
import json
import os
import random
import resource
import shutil
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

OTHERS = [None, True, -1, 1e300, "x", [], [1], ["x"], {}, {"command": 1}, [[1]], [{}]]
LAMP = {"name": "lamp", "mesh": "square", "material": "white", "theta": 180,
        "scale": [0.3, 0.3, 1], "emission": [9, 9, 9], "at": [0, 0, 1]}
BALL = {"name": "ball", "mesh": "square", "material": "white", "theta": 0, "phi": 0,
        "at": [0, 0, 0]}
CAMERA = {"name": "front", "position": [0, -4, 1], "target": [0, 0, 1], "field_of_view": 36,
          "width": 8, "height": 8}
SCENE = {"format": "hshfit-scene", "version": 1, "about": "a lamp",
         "materials": [{"name": "white", "brdf": "lambert:kd=.7"}], "objects": [BALL, LAMP],
         "cameras": [CAMERA]}
PLAN = {"format": "hshfit-scene", "version": 1,
        "materials": [{"name": "paint", "brdf": "lambert:kd=.5", "orientations": [{"theta": 20}]}],
        "lights": [{"kind": "disc", "theta": 40, "angular_diameter": 20, "irradiance": 3},
                   {"kind": "sky", "model": "overcast", "radiance": [1, 2, 3]}],
        "views": {"theta": [0, 70], "tangent": "fixed"},
        "budget": {"metric": "relative_l2", "error": 0.2}}
MAP = {"format": "hshfit-svbrdf", "version": 1, "model": "ggx",
       "parameters": {"alpha": {"map": "r.pfm", "scale": 0.5, "offset": 0.3}, "F0": 0.5},
       "normal": {"map": "n.pfm", "encoding": "signed"}, "source": "test"}
FLAT = {key: value for key, value in MAP.items() if key != "normal"}
VERTICES = struct.pack("<9f3H2x", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 2)
GLTF = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "translation": [0, 0, 1], "children": []}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": 4}]}],
        "accessors": [
            {"bufferView": 0, "byteOffset": 0, "componentType": 5126, "count": 3, "type": "VEC3",
             "normalized": False,
             "sparse": {"count": 1, "indices": {"bufferView": 1, "componentType": 5123},
                        "values": {"bufferView": 0}}},
            {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36},
                        {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
        "buffers": [{"byteLength": 44, "uri": "data:application/octet-stream;base64," +
                     base64.b64encode(VERTICES).decode()}]}
MANIFEST = [{"defaults": {"command": "project", "options": {"order": 3}, "output": "c.json",
                          "name": "{stem}", "cost": 2}},
            {"input": ["lambert", "phong:exponent=22"], "options": {"outgoing": 4}, "cost": 1},
            {"command": "compare", "input": "lambert:kd=.3", "with": "lambert", "name": "n",
             "options": {}}]
PHONG = "phong:exponent=9,ks=.5"
FORMS = {"halfway": ["--form", "halfway"],
         "basis": ["--form", "basis", "--order", "3", "--rank", "2"],
         "split": ["--order", "3", "--outgoing", "4x4", "--split", "diffuse"]}

# Input -> (its file, the commands that make it from what was made before, the command that reads
# it, with "{}" for the file).
INPUTS = {
    "scene": ("scene.json", [], ["illuminate", "{}", "-o", "out", "--samples", "1"]),
    "transfer": ("scene.json", [], ["transfer", "{}", "-o", "out", "--rays", "4", "--order", "2"]),
    "plan": ("plan.json", [], ["plan", "{}", "-o", "out", "--max-order", "2"]),
    "map": ("map.json", [], ["svbrdf", "{}", "-o", "out"]),
    "mesh": ("mesh.gltf", [], ["render", "lambert", "--mesh", "{}", "-o", "out.png", "--size", "8",
                               "--by", "integration", "--light", "45,0"]),
    "preset": ("preset.json", [], ["eval", "{}", "--wi", "30,0", "--wo", "40,90"]),
    "coefficients": ("c.json", [["project", PHONG, "-o", "c.json", "--order", "3", "--outgoing",
                                 "4x4"]], ["eval", "{}", "--wi", "30,0", "--wo", "40,90"]),
    "light": ("l.json", [["light", "uniform:radiance=1", "-o", "l.json", "--order", "2"]],
              ["irradiance", "{}"]),
    "sidecar": ("e/c.hsh.json", [["project", PHONG, "-o", "c.json", "--order", "3",
                                  "--outgoing", "4x4"],
                                 ["export", "c.json", "-o", "e", "--target", "bin"]],
                ["import", "{}", "-o", "out.json"]),
    "material": ("m/material.json", [["svbrdf", "flat.json", "-o", "m", "--form", "low-rank",
                                      "--order", "2", "--outgoing", "4"]],
                 ["export", "{}", "-o", "out", "--target", "ktx2"]),
    "filtered": ("fm/material.json", [["svbrdf", "map.json", "-o", "fm"]],
                 ["export", "{}", "-o", "out", "--target", "ktx2"]),
    "gaussians": ("g.json", [["gaussians", PHONG, "-o", "g.json", "--lobes", "1"]],
                  ["eval", "{}", "--wi", "30,0", "--wo", "40,90"]),
}
for form, options in FORMS.items():
    INPUTS[f"form {form}"] = (
        f"{form}.json", [["project", PHONG, "-o", f"{form}.json", *options]],
        ["eval", "{}", "--wi", "30,0", "--wo", "40,90"])


def pfm(path, values):
    colour = isinstance(values[0], tuple)
    flat = [v for each in values for v in (each if colour else (each,))]
    path.write_bytes(f"{'PF' if colour else 'Pf'}\n2 2\n-1\n".encode() +
                     struct.pack(f"<{len(flat)}f", *flat))


def run(program, words, folder):
    def bound():
        resource.setrlimit(resource.RLIMIT_CPU, (20, 21))
        resource.setrlimit(resource.RLIMIT_AS, (2 << 30, 2 << 30))
    return subprocess.run([program, *words, "--threads", "1", "--quiet"], cwd=folder, check=False,
                          stdin=subprocess.DEVNULL, capture_output=True, preexec_fn=bound)


def places(value, at=()):
    """The keys that lead to each value; of long lists the first two and the last."""
    yield at
    if isinstance(value, dict):
        for key in value:
            yield from places(value[key], at + (key,))
    elif isinstance(value, list):
        for key in sorted({*range(min(2, len(value))), len(value) - 1} - {-1}):
            yield from places(value[key], at + (key,))


def changed(document, at, other):
    if not at:
        return other
    document = copy.deepcopy(document)
    holder = document
    for key in at[:-1]:
        holder = holder[key]
    holder[at[-1]] = other
    return document


class Trial:
    def __init__(self, arguments, folder):
        self.arguments, self.folder = arguments, folder
        self.random = random.Random(arguments.seed)
        self.breaches = self.runs = self.refused = 0

    def held(self, label, path, text, words, codes=(0, 2, 3, 4), other=None):
        path.write_text(text, encoding="utf-8")
        for out in self.folder.glob("out*"):
            shutil.rmtree(out) if out.is_dir() else out.unlink()
        result = run(self.arguments.program, words, self.folder)
        self.runs += 1
        self.refused += result.returncode == 3
        error = result.stderr.decode("utf-8", "replace")
        # A value may name another file, or the source that a file of coefficients states,
        # and its message starts with that one.
        names = (path.name, "r.pfm: ", "n.pfm: ", f"hshfit: {other}:", "hshfit: phong:ks=")
        named = result.returncode == 0 or any(name in error for name in names)
        if result.returncode in codes and "internal error" not in error and named:
            return
        self.breaches += 1
        print(f"{label}: exit {result.returncode}: {error.strip()[-300:]}", flush=True)

    def each(self, label, document, path, words, text=json.dumps):
        for at in places(document):
            for other in self.random.sample(OTHERS, min(self.arguments.kinds, len(OTHERS))):
                self.held(f"{label}, {'.'.join(map(str, at))} = {json.dumps(other)}", path,
                          text(changed(document, at, other)), words, other=other)

    def input(self, name):
        file, made, reader = INPUTS[name]
        for words in made:
            result = run(self.arguments.program, [*words, "--force"], self.folder)
            if result.returncode != 0:
                raise SystemExit(f"{' '.join(words)}: {result.stderr.decode()}")
        path = self.folder / file
        original = path.read_text(encoding="utf-8")
        words = [file if word == "{}" else word for word in reader]
        self.held(f"{name} as it is", path, original, words, (0,))
        self.each(name, json.loads(original), path, words)
        path.write_text(original, encoding="utf-8")

    def manifest(self):
        path = self.folder / "items.jsonl"
        words = ["batch", path.name, "-o", "out", "--check"]

        def text(lines):
            return "".join(json.dumps(line) + "\n" for line in lines)
        self.held("manifest as it is", path, text(MANIFEST), words, (0,))
        for line in range(len(MANIFEST)):
            self.each(f"manifest, line {line + 1}", MANIFEST[line], path, words,
                      lambda new, line=line: text([*MANIFEST[:line], new, *MANIFEST[line + 1:]]))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program", type=os.path.abspath)
    parser.add_argument("--kinds", type=int, default=len(OTHERS))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", help="inputs whose name holds this")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="hshfit-types-") as name:
        folder = Path(name)
        for file, document in {"scene.json": SCENE, "plan.json": PLAN, "map.json": MAP,
                               "flat.json": FLAT,
                               "mesh.gltf": GLTF, "preset.json": {
                                   "format": "hshfit-preset", "version": 1, "spec": PHONG,
                                   "source": "test"}}.items():
            (folder / file).write_text(json.dumps(document), encoding="utf-8")
        pfm(folder / "r.pfm", [0.1, 0.4, 0.7, 1.0])
        pfm(folder / "n.pfm", [(0.0, 0.0, 1.0)] * 4)
        trial = Trial(arguments, folder)
        for each in INPUTS:
            if arguments.only in each or not arguments.only:
                trial.input(each)
        if arguments.only in "manifest":
            trial.manifest()
    print(f"{trial.runs} files, {trial.refused} refused, {trial.breaches} breaches")
    return 1 if trial.breaches else 0


if __name__ == "__main__":
    sys.exit(main())
