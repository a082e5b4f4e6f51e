#!/usr/bin/env python3
"""mutated_files.py PROGRAM SEEDS [--files N] [--first K] [--seed S] [--data FOLDER] [--keep FOLDER]
[--only READER] [--sanitized]: damaged files of every reader are read or refused.

SEEDS is the folder that make_seeds fills, with what fuzz targets kept in it; FOLDER has real files
(../shared/data, left out where absent). N times, a reader is picked, one of its files is damaged
one to three times (`MUTATIONS` below: bits, numbers, lengths, nesting, control characters), and
PROGRAM runs on it with one thread: `info` mostly, else `eval`, `project`, `convert`, `import`, or
a command of the reader (`COMMANDS` below). File K is the same in every run with the seed S.
Each run has to

- end by itself, with 0, 2, 3, 4 or 5, within 5 s of CPU (5 s per MB of larger files) and 2 GiB;
- print no line of standard error beyond 500 characters, and no raw control character;
- name the file on standard error where it fails, and answer in JSON that parses where asked to.

Breaches are printed, and their files kept in the folder of --keep. --sanitized: PROGRAM is built
with sanitizers: 20 times the time, and no limit of memory. Ends with 1 if there is a breach.
"""
import argparse
import concurrent.futures
import json
import os
import random
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from pathlib import Path

# Fuzz target -> extension of the files that its inputs are; None: those of the names of the seeds.
TARGETS = {"alta": ".alta", "astm": ".astm", "cornell": ".brdf", "csv": ".csv", "nist": ".csv",
           "scatmech": ".csv", "fred": ".txt", "zemax": ".bsdf", "speos": ".brdf",
           "xompt": ".xompt",
           "mit": ".dat", "pbsdf": ".pbsdf", "rgl": ".bsdf", "presets": ".json",
           "gaussians": ".json", "bsdf_xml": ".xml", "merl_slice": ".slice", "utia": ".bin",
           "merl": ".binary", "pab_opto": ".dat", "bird": ".json", "weather": ".epw",
           "sky_tables": ".h",
           "material_library": ".library", "coefficients": ".json", "gpu_containers": None}
DATA = {"alta": "alta", "bsdf_xml": "bsdf_xml", "cornell": "cornell", "nist_ptfe": "nist",
        "rgl": "rgl", "merl_slices": "merl_slice", "hostile": "alta", "env": "pictures"}
EXR = b"\x76\x2f\x31\x01"
PAIRS = b"wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,note\n0.6,0,0.8,0,0.6,0.8,a\n0,0,1,0.28,0,0.96,\"b\"\n"
SCENE = {"format": "hshfit-scene", "version": 1,
         "materials": [{"name": "paint", "brdf": "lambert:kd=.5", "orientations": [{"theta": 20}]}],
         "lights": [{"kind": "disc", "theta": 40, "angular_diameter": 20, "irradiance": 3},
                    {"kind": "sky", "model": "overcast", "radiance": [1, 2, 3]}],
         "views": {"theta": [0, 70], "tangent": "fixed"},
         "budget": {"metric": "relative_l2", "error": 0.2}}
COVARIANCE = {"format": "hshfit-covariance", "version": 1,
              "wavelength": {"nodes": [450, 550], "matrix": [[1, 0.5], [0.5, 1]]},
              "angle": {"nodes": [-40, 0, 40], "matrix": [[4, 1, 0], [1, 4, 1], [0, 1, 4]]}}
# Commands of readers whose files are no BRDF by themselves.
COMMANDS = {"pairs": ["eval lambert --pairs {path} -o {out}.csv"],
            "covariance": ["fit lambert --model lambert --loss l2 -o {out}.fit.json "
                           "--scans incidence --sigma 2%,covariance={path}"],
            "scene": ["plan {path} -o {out}.plan --max-order 2"],
            "weather": [f"light {kind}:file={{path}},date={moment} -o {{out}}.json --order 3"
                        for kind in ("perez", "sun")
                        for moment in ("1996-06-21,time=12:30", "1995-01-01,time=12:30")],
            "sky_tables": ["light hosek-wilkie:data={path},elevation=30 -o {out}.json --order 3"],
            "material_library": ["info {path}:b --json", "library list {path}",
                                 "library list {path} --json", "eval {path}:a --wi 30,0 --wo 45,10",
                                 "library decode {path}:a -o {out}.library",
                                 "library search {path} lambert",
                                 "library map {path} -o {out}.html"]}
# Readers of Mueller matrices, and elements beside the default.
MUELLER, ELEMENTS = {"nist", "scatmech", "pbsdf"}, ["m01", "m12/m22", "m00/dolp", "all"]
NUMBER = re.compile(rb"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
ODD_NUMBERS = [b"nan", b"NaN", b"-nan", b"inf", b"-inf", b"Infinity", b"1e308", b"-1e308", b"1e309",
               b"1e-320", b"1e99999", b"-0", b"0", b"-1", b"1", b"90", b"3.1415927", b"2147483647",
               b"2147483648", b"4294967296", b"9223372036854775807", b"18446744073709551616",
               b"1e18", b"999999999", b"65536", b"0x10", b"1,5", b"1e", b".", b"--1", b"",
               b"9" * 400, b"0." + b"0" * 400 + b"1", b"null", b"true", b'"1"', b"[1]", b"{}"]
ODD_BYTES = [bytes(8), b"\xff" * 8, b"\xff" * 4, bytes(4), b"\0\0\xc0\x7f", b"\0\0\x80\x7f",
             b"\0\0\x80\xff", bytes(6) + b"\xf8\x7f", bytes(6) + b"\xf0\x7f",
             bytes(6) + b"\xf0\xff", b"\xff\xff\xff\x7f", b"\0\0\0\x80", b"\xff" * 7 + b"\x7f",
             b"\xff" * 6 + b"\xef\x7f", b"\xff\xff\x7f\x7f", b"\1\0\0\0"]
CONTROLS = [b"\x00", b"\x1b[2J", b"\x1b]0;x\x07", b"\r", b"\x08", b"\x7f", b"\xc2\x9b", b"\xff\xfe",
            b"\xe2\x80\xae", b"\n", b"\t", b"\xc3", b"\xed\xa0\x80", b"'", b'"', b"<", b"&#0;"]
NESTS = [(b"[", b"]"), (b'{"a":', b"}"), (b"<a>", b"</a>"), (b"rgb:", b""), (b"grey:", b""),
         (b"0.5 * ", b""), (b"lambert + ", b""), (b"(", b")"), (b"{", b"}"), (b"#", b""),
         (b" ", b""), (b"\n", b""), (b"9", b""), (b"x", b""), (b"../", b""), (b"1 ", b"")]


# --- Mutations: (bytes, random, another file of the reader) -> bytes.

def flip(data, rng, _):
    data = bytearray(data)
    for _bit in range(rng.choice([1, 1, 2, 8, 64])):
        data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
    return bytes(data)


def flip_head(data, rng, other):
    head = min(len(data), 512)
    return flip(data[:head], rng, other) + data[head:]


def truncate(data, rng, _):
    return data[:rng.randrange(len(data))] if rng.random() < 0.8 else data + rng.randbytes(9)


def splice(data, rng, other):
    at = rng.randrange(len(data))
    if rng.random() < 0.5:  # the other file goes on at the same place
        return data[:at] + other[at:]
    return data[:at] + other[rng.randrange(len(other)):]


def block(data, rng, _):
    """A block is left out, doubled, or moved."""
    size = min(len(data), rng.choice([1, 4, 8, 50, 1000]))
    at, to = rng.randrange(len(data)), rng.randrange(len(data))
    piece = data[at:at + size]
    rest = data[:at] + data[at + size:]
    return rng.choice([rest, data[:at] + piece + data[at:], rest[:to] + piece + rest[to:]])


def lines(data, rng, _):
    """A line is left out, doubled, repeated many times, or exchanged with another."""
    rows = data.split(b"\n")
    i, j = rng.randrange(len(rows)), rng.randrange(len(rows))
    kind = rng.randrange(4)
    if kind == 0:
        del rows[i]
    elif kind == 1:
        rows[i:i] = [rows[i]]
    elif kind == 2:
        rows[i:i] = [rows[i]] * min(2000, 1 + 200000 // (1 + len(rows[i])))
    else:
        rows[i], rows[j] = rows[j], rows[i]
    return b"\n".join(rows)


def number(data, rng, _):
    """Numbers of a text are doubled, replaced, shifted by powers of ten, or negated."""
    start = rng.randrange(len(data)) if rng.random() < 0.7 else 0
    places = [match.span() for match in NUMBER.finditer(data[start:start + 3000])]
    if not places:
        return flip(data, rng, _)
    for begin, end in sorted(rng.sample(places, min(len(places), rng.choice([1, 1, 1, 3]))),
                             reverse=True):
        begin, end = begin + start, end + start
        old = data[begin:end]
        new = rng.choice([old + old, old + b" " + old, old + b"," + old, b"-" + old, old + b"e9",
                          old + b"e300", old + b"0", old[:-1]] + [rng.choice(ODD_NUMBERS)] * 8)
        data = data[:begin] + new + data[end:]
    return data


def nudge(data, rng, _):
    """Some digits become others: most files can still be read."""
    places = [at for at in range(len(data)) if 48 <= data[at] < 58] if len(data) < 20000 else []
    if not places:
        places = [rng.randrange(len(data)) for _ in range(100)]
    data = bytearray(data)
    for at in rng.sample(places, min(len(places), rng.choice([1, 1, 5, 30]))):
        data[at] = rng.randrange(48, 58) if 48 <= data[at] < 58 else data[at] ^ 1
    return bytes(data)


def binary(data, rng, _):
    """Aligned words become NaN, infinity, or the ends of the integers."""
    data = bytearray(data)
    reach = len(data) if rng.random() < 0.5 else min(len(data), 256)
    for _word in range(rng.choice([1, 1, 2, 10])):
        new = rng.choice(ODD_BYTES)
        at = rng.randrange(reach) // 4 * 4
        data[at:at + len(new)] = new[:max(0, len(data) - at)]
    return bytes(data)


def control(data, rng, _):
    for _place in range(rng.choice([1, 1, 3])):
        at = rng.randrange(len(data) + 1)
        data = data[:at] + rng.choice(CONTROLS) * rng.choice([1, 1, 300]) + data[at:]
    return data


def nest(data, rng, _):
    """Prefixes a place, best the beginning of a value, with many of the same."""
    begin, end = rng.choice(NESTS)
    count = rng.choice([2, 5, 100, 5000, 20000])
    starts = [0, rng.randrange(len(data))]
    starts += [found.end() for found in re.finditer(rb'["=:>{\[,\n] ?', data[:20000])]
    at = rng.choice(starts)
    return data[:at] + begin * count + (data[at:] + end * count if rng.random() < 0.5 else
                                        end * count + data[at:])


def word(data, rng, _):
    """A word becomes another word of the file, or goes."""
    words = list(re.finditer(rb"[A-Za-z_][A-Za-z_0-9-]*", data[:20000]))
    if not words:
        return binary(data, rng, _)
    old, new = rng.choice(words), rng.choice(words)
    text = rng.choice([new.group(), b"", old.group() * 2, old.group().swapcase(), b"\xc3\xa9"])
    return data[:old.start()] + text + data[old.end():]


MUTATIONS = [flip, flip, flip_head, truncate, splice, block, lines, number, number, number, nudge,
             nudge, nudge, binary, binary, control, nest, word]


# --- Seeds.

class Seed:
    """A file; of those too large to be kept, the pieces that it consists of."""

    def __init__(self, data, name, size=0, beside=None):
        self.data, self.name, self.size, self.beside = data, name, size, beside


def from_target(target, path, folder):
    """The file that an input of a fuzz target stands for."""
    data, extension = path.read_bytes(), TARGETS[target]
    if not data:
        return None
    if extension is None:  # exports: files beside each other, which libFuzzer's own have not
        return Seed(data, path.name, beside=folder) if "." in path.name else None
    if data.startswith(EXR):
        return Seed(data, "seed.exr")
    if target == "bsdf_xml":
        data = data[1:]
    elif target == "merl_slice":
        data = (data * (1 + 97200 // len(data)))[:97200]
    elif target == "utia":
        data = (data[1:9] * (1 + 1990656 // 8))[:1990656] if len(data) > 8 else None
    elif target == "merl":  # a head, then zeros, with cells in between
        if len(data) < 14:
            return None
        return Seed(data[:12] + data[14:], "seed" + extension, 12 + 8 * 3 * 90 * 90 * 180)
    return Seed(data, "seed" + extension) if data else None


def gather(seeds, data):
    found = {"pairs": [Seed(PAIRS, "pairs.csv")],
             "scene": [Seed(json.dumps(SCENE).encode(), "scene.json")],
             "covariance": [Seed(json.dumps(COVARIANCE).encode(), "covariance.json")]}
    for target in TARGETS:
        folder = Path(seeds) / f"fuzz_{target}"
        files = sorted(path for path in folder.glob("*") if path.is_file())
        made = [from_target(target, path, folder) for path in files]
        found[target] = [seed for seed in made if seed]
        if not found[target]:
            raise SystemExit(f"{folder} has no seeds; make_seeds {seeds} writes them")
    for folder, reader in DATA.items() if data else []:
        for path in sorted(Path(data, folder).glob("*.*")):
            if path.stat().st_size < 1.2e6:
                seed = Seed(path.read_bytes(), path.name)
                found.setdefault(reader, []).append(seed)
    return found


# --- Runs.

class Trial:
    def __init__(self, arguments, seeds):
        self.arguments, self.seeds = arguments, seeds
        self.readers = sorted(reader for reader in seeds if arguments.only in reader)
        self.local, self.lock = threading.local(), threading.Lock()
        self.top = Path(tempfile.mkdtemp(prefix="hshfit-mutated-"))
        self.breaches, self.counts, self.slowest = [], Counter(), []

    def folder(self):
        """A folder of this thread, with the exports of which one file at a time is damaged."""
        if not hasattr(self.local, "folder"):
            self.local.folder = Path(tempfile.mkdtemp(dir=self.top))
            source = self.seeds["gpu_containers"][0].beside
            for path in source.iterdir():
                shutil.copy(path, self.local.folder / path.name)
        return self.local.folder

    def mutated(self, seed, reader, rng):
        data, names = seed.data, []
        for _ in range(rng.choice([1, 1, 1, 2, 3])):
            mutation = rng.choice(MUTATIONS)
            names.append(mutation.__name__)
            data = mutation(data, rng, rng.choice(self.seeds[reader]).data) or b"\n"
        return data[:8 << 20], names

    def words(self, reader, path, sidecar, rng):
        """The command line for a file, and where it asks for JSON."""
        out = path.parent / "out"
        if reader in COMMANDS:
            words = rng.choice(COMMANDS[reader]).split()
            return [word.format(path=path, out=out) for word in words], "--json" in words
        if reader == "gpu_containers":
            path = sidecar if sidecar and rng.random() < 0.8 else path
            if rng.random() < 0.4:
                return ["import", path, "-o", f"{out}.json", "--force"], False
        if reader in MUELLER and rng.random() < 0.5:
            path = f"{path}:mueller={rng.choice(ELEMENTS)}"
        kind = rng.random()
        if kind < 0.10:
            return ["eval", path, "--wi", "30,0", "--wo", "45,10"], False
        if kind < 0.20:
            # The bound of the work, a minute if a value of a scattered file is 1e300, is an option.
            return ["project", path, "-o", f"{out}.json", "--order", "2", "--outgoing", "2",
                    "--max-evaluations", "1e6"], False
        if kind < 0.25:
            return ["convert", path, f"{out}.alta", "--to", "alta:theta=4,phi=8", "--force"], False
        return (["info", path, "--json"], True) if kind < 0.6 else (["info", path], False)

    def one(self, index):
        rng = random.Random(f"{self.arguments.seed}:{index}")
        reader = rng.choice(self.readers)
        seed = rng.choice(self.seeds[reader])
        data, mutations = self.mutated(seed, reader, rng)
        folder = self.folder()
        path = folder / (seed.name if seed.beside else f"m{index}{Path(seed.name).suffix}")
        self.write(path, seed, data)
        sidecar = None
        if seed.beside and ".coef" in seed.name or ".basis" in seed.name:
            sidecar = folder / (re.split(r"\.(coef|basis)", seed.name)[0] + ".hsh.json")
            sidecar = sidecar if sidecar.exists() else None
        words, as_json = self.words(reader, path, sidecar, rng)
        megabytes = max(1, path.stat().st_size / 1e6 if not seed.size else 5)
        result = self.run(folder, [str(word) for word in words], as_json, megabytes)
        found = self.judge(result, as_json, path, sidecar, 5 * megabytes)
        with self.lock:
            self.counts[f"exit {result['code']}"] += 1
            self.slowest.append((result["seconds"], index, reader, words[0]))
            if found:
                self.report(found, index, reader, mutations, path, words)
        if seed.beside:
            shutil.copy(seed.beside / seed.name, path)
        else:
            path.unlink()
        for left in folder.glob("out*"):
            shutil.rmtree(left) if left.is_dir() else left.unlink()

    @staticmethod
    def write(path, seed, data):
        with open(path, "wb") as file:
            file.write(data[:12] if seed.size else data)
            if seed.size and len(data) >= 12:  # pieces of 12 bytes: number of a cell and its value
                for at in range(12, len(data) - 11, 12):
                    file.seek(12 + 8 * (int.from_bytes(data[at:at + 4], "little") % 4374000))
                    file.write(data[at + 4:at + 12])
                file.truncate(seed.size)

    def run(self, folder, words, as_json, megabytes):
        sanitized = self.arguments.sanitized
        with open(folder / "stdout", "w+b") as out, open(folder / "stderr", "w+b") as error:
            process = subprocess.Popen([self.arguments.program, *words, "--threads", "1"],
                                       cwd=folder, stdin=subprocess.DEVNULL, stdout=out,
                                       stderr=error)
            limits = {resource.RLIMIT_CPU: int(5 * megabytes + 1) * (20 if sanitized else 1)}
            if not sanitized:
                limits[resource.RLIMIT_AS] = 2 << 30
            for limit, value in limits.items():
                try:
                    resource.prlimit(process.pid, limit, (value, value + 1))
                except ProcessLookupError:
                    pass
            waiting = threading.Timer(300, process.kill)
            waiting.start()
            _, status, used = os.wait4(process.pid, 0)
            waiting.cancel()
            process.returncode = os.waitstatus_to_exitcode(status)
            out.seek(0)
            error.seek(0)
            return {"code": process.returncode, "seconds": used.ru_utime + used.ru_stime,
                    "stdout": out.read(1 << 24), "stderr": error.read(1 << 24)}

    def judge(self, result, as_json, path, sidecar, limit):
        found = []
        code, error = result["code"], result["stderr"]
        if code < 0 or code not in (0, 2, 3, 4, 5):
            found.append(f"exit {code}")
        if result["seconds"] > limit * (20 if self.arguments.sanitized else 1):
            found.append(f"{result['seconds']:.1f} s of CPU")
        for line in error.split(b"\n"):
            if len(line) > 500:
                found.append(f"a message of {len(line)} bytes")
        for name, text in (("error", error), ("output", result["stdout"])):
            if has_control(text, b"\n" if name == "error" else b"\n\t"):
                found.append(f"control character in standard {name}")
        names = [path.name, path.name.split(".")[0] + "."] + ([sidecar.name] if sidecar else [])
        if code != 0 and not any(name.encode() in error for name in names):
            found.append("no name of the file")
        if code != 0 and not error.endswith(b"\n"):
            found.append("no message")
        if code == 0 and as_json:
            try:
                json.loads(result["stdout"], parse_constant=refuse)
            except ValueError as problem:
                found.append(f"JSON: {problem}")
        if found:
            found.append(error[-300:].decode("utf-8", "backslashreplace").strip())
        return found

    def report(self, found, index, reader, mutations, path, words):
        kept = Path(self.arguments.keep or self.top) / f"{index}-{path.name}"
        if self.arguments.keep:
            kept.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(path, kept)
        line = " ".join(str(word) for word in words).replace(str(path), str(kept))
        self.breaches.append(f"{index}, {reader}, {'+'.join(mutations)}: {'; '.join(found)}\n"
                             f"    {line}")
        print(self.breaches[-1], flush=True)


def refuse(constant):
    raise ValueError(f"{constant} is no JSON")


def has_control(text, allowed):
    try:
        characters = text.decode("utf-8")
    except UnicodeDecodeError:
        return True
    return any((ord(c) < 32 or 127 <= ord(c) < 160 or c in "\u2028\u2029\u202e") and
               c.encode() not in allowed for c in characters)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program", type=os.path.abspath)
    parser.add_argument("seeds")
    parser.add_argument("--files", type=int, default=20000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--data", default="")
    parser.add_argument("--keep", default="")
    parser.add_argument("--only", default="", help="readers whose name holds this")
    parser.add_argument("--sanitized", action="store_true")
    arguments = parser.parse_args()
    data = arguments.data if arguments.data and Path(arguments.data).is_dir() else None
    seeds = gather(arguments.seeds, data)
    trial = Trial(arguments, seeds)
    begin = time.monotonic()
    try:
        numbers = range(arguments.first, arguments.first + arguments.files)
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            for _ in pool.map(trial.one, numbers):
                pass
    finally:
        shutil.rmtree(trial.top, ignore_errors=True)
    seconds = time.monotonic() - begin
    print(f"{arguments.files} files of {len(trial.readers)} readers, seed {arguments.seed}, "
          f"{len(trial.breaches)} breaches, {arguments.files / seconds:.1f} files a second")
    print("  " + ", ".join(f"{name}: {trial.counts[name]}" for name in sorted(trial.counts)))
    for used, index, reader, command in sorted(trial.slowest, reverse=True)[:5]:
        print(f"  {used:.2f} s of CPU: file {index}, {reader}, {command}")
    return 1 if trial.breaches else 0


if __name__ == "__main__":
    sys.exit(main())
