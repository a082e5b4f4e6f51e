#!/usr/bin/env python3
"""interrupted_writes.py PROGRAM [--moments N] [--seed S] [--only WORD]: commands that write are cut
short, and nothing cut may stand under a final name.

Every command that writes files is run to its end, for what it writes, and then

- N times with SIGTERM and N times with SIGKILL at a random moment of its run,
- N / 3 times with a random limit on the size of a file,
- N / 3 times into a file system with too little space (a tmpfs; skipped where none can be mounted),

command after command in turn, each time with a folder that is empty or holds the files of an
earlier run. Every file under a final name has to be the earlier one or the complete new one. But
for SIGKILL, the files have to be all new or all earlier ones, and no temporary, folder or link may
be left; of SIGKILL, temporaries and sets of which some files are new are counted. Prints each
breach, then the counts; ends with 1 if there is a breach.
"""
import argparse
import hashlib
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

TOP = Path(__file__).resolve().parent.parent
EARLIER = b"what stood there before\n"
SCENE = {"format": "hshfit-scene", "version": 1,
         "materials": [{"name": "paint", "brdf": "phong:exponent=3"}],
         "lights": [{"kind": "disc", "theta": 40, "angular_diameter": 20, "irradiance": 3}],
         "views": {"theta": [0, 70], "tangent": "fixed"},
         "budget": {"metric": "relative_l2", "error": 0.2}}

# Names after -o and OUT are relative to the folder written to; INPUTS stands for that of the
# inputs. Commands whose files hold measured times leave them out.
COMMANDS = {
    "project": "project phong:exponent=5 --order 4 --outgoing 16x16 -o out/c.json",
    "project exr": "project phong:exponent=5 --order 4 --outgoing 16x16 -o out/c.exr",
    "project many": "project phong:exponent=5 lambert ggx:alpha=.3 --order 4 --outgoing 8x8 -o set",
    "project form": "project ggx:alpha=.5 --form basis --order 4 -o out/c.json",
    "report": "report ggx:alpha=.5 phong:exponent=3 -o set --max-order 3 --outgoing 4 --bases hsh",
    "compare": "compare phong:exponent=3 lambert --metrics relative-l2 --outgoing 4 -o set",
    "tradeoff": "tradeoff phong:exponent=3 --forms outgoing --bases hsh --orders 3 --outgoing 4 "
                "--pair-count 1024 --no-timing --write-pairs out/pairs.csv -o set",
    "plan": "plan INPUTS/scene.json --max-order 3 -o set",
    "stress": "stress lambert --bases hsh --max-order 4 -o set",
    "render": "render ggx:alpha=.3 --size 64 --samples 1 -o out/p.png",
    "render exr": "render ggx:alpha=.3 --size 64 --samples 1 -o out/p.exr",
    "convert": "convert ggx:alpha=.3 out/g.alta --force",
    "convert slices": "convert ggx:alpha=.3 out/g.exr --to slices:size=64 --force",
    "convert xml": "convert ggx:alpha=.3 out/g.xml --to bsdf-klems --force",
    "fit": "fit ggx:alpha=.3 --model ggx --samples 300 --starts 1 -o out/f.json",
    "fit page": "fit ggx:alpha=.3 --model ggx --samples 300 --starts 1 -o set",
    "fit models": "fit ggx:alpha=.3 --compare-models ggx lambert --samples 200 --starts 1 "
                  "-o out/m.json",
    "export": "export INPUTS/c.json -o set --force --target exr,ktx2,glsl,hlsl",
    "import": "import INPUTS/c.hsh.json -o out/i.json --force",
    "rotate": "rotate INPUTS/c.json -o out/r.json --euler 0,30,0",
    "eval": "eval ggx:alpha=.3 --pairs INPUTS/pairs.csv -o out/e.csv",
    "gaussians": "gaussians ggx:alpha=.4 --outgoing 4 --lobes 1 -o out/g.json",
    "ltc": "ltc ggx --size 3 -o out/l.json -o out/l.exr -o out/l.dds",
}


def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


class Run:
    """One command, run in a folder of its own."""

    def __init__(self, program, words, folder):
        self.folder = Path(folder)
        (self.folder / "out").mkdir()
        # Earlier files are replaced: by their bytes they are somebody else's.
        self.words = [program] + words.split() + ([] if "--force" in words else ["--force"])

    def start(self, limit=None):
        def narrow():
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, resource.RLIM_INFINITY))
        return subprocess.Popen(self.words, cwd=self.folder, stdin=subprocess.DEVNULL,
                                stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                preexec_fn=None if limit is None else narrow)

    def files(self):
        return {str(path.relative_to(self.folder)): digest(path)
                for path in self.folder.rglob("*") if path.is_file()}

    def stand(self, names):
        for name in names:
            (self.folder / name).parent.mkdir(exist_ok=True)
            (self.folder / name).write_bytes(EARLIER)


class Trial:
    def __init__(self, program, seed):
        self.program = program
        self.random = random.Random(seed)
        self.top = Path(tempfile.mkdtemp(prefix="hshfit-writes-"))
        self.inputs = self.top / "inputs"
        self.inputs.mkdir()
        self.number = 0
        self.complete, self.seconds, self.largest = {}, {}, {}
        self.breaches, self.counts = [], Counter()

    def prepare(self, names):
        (self.inputs / "scene.json").write_text(json.dumps(SCENE))
        row = "0.6,0,0.8,0,0.6,0.8\n"
        (self.inputs / "pairs.csv").write_text("wi_x,wi_y,wi_z,wo_x,wo_y,wo_z\n" + 3000 * row)
        for words in ("project phong:exponent=5 --order 4 --outgoing 8x8 -o c.json",
                      "export c.json -o . --target bin --name c"):
            subprocess.run([self.program] + words.split(), cwd=self.inputs, check=True,
                           stdout=subprocess.DEVNULL)
        for name in names:
            first, second = (self.finished(name) for _ in range(2))
            if first != second:
                different = sorted(key for key in first if first[key] != second.get(key))
                self.breaches.append(f"{name}: two runs differ in {different}")
            self.complete[name] = first

    def finished(self, name):
        run = self.fresh(name)
        begin = time.monotonic()
        process = run.start()
        error = process.communicate()[1]
        self.seconds[name] = time.monotonic() - begin
        files = run.files()
        if process.returncode != 0 or not files:
            raise SystemExit(f"{name}: ended with {process.returncode}: {error.decode()}")
        self.largest[name] = max((run.folder / path).stat().st_size for path in files)
        shutil.rmtree(run.folder)
        return files

    def fresh(self, name, under=None):
        self.number += 1
        folder = (under or self.top) / f"run{self.number}"
        folder.mkdir()
        return Run(self.program, COMMANDS[name].replace("INPUTS", str(self.inputs)), folder)

    def check(self, name, run, kind, stood, code):
        """Holds what is left behind to the rules."""
        complete, left = self.complete[name], run.files()
        earlier = hashlib.sha256(EARLIER).hexdigest()
        where = f"{name}, {kind}, {'over earlier files' if stood else 'into nothing'}, exit {code}"
        temporaries = [path for path in left if Path(path).name.startswith(".hshfit-")]
        new = {path for path in left if left[path] == complete.get(path)}
        old = {path for path in left if left[path] == earlier}
        cut = set(left) - new - old - set(temporaries)
        if cut:
            self.breaches.append(f"{where}: cut in place: {sorted(cut)}")
        if stood and len(new) + len(old) < len(complete):
            self.breaches.append(f"{where}: earlier files are gone")
        mixed = 0 < len(new) < len(complete)
        killed = kind == "SIGKILL"
        self.counts[f"{kind}: runs"] += 1
        self.counts[f"{kind}: with all files new"] += len(new) == len(complete)
        if killed:
            self.counts["SIGKILL: with temporaries"] += bool(temporaries)
            self.counts["SIGKILL: with some files new"] += mixed
            return
        if temporaries:
            self.breaches.append(f"{where}: temporaries: {sorted(temporaries)}")
        if mixed:
            self.breaches.append(f"{where}: only some files are new: {sorted(new)}")
        if not left and (run.folder / "set").exists():
            self.breaches.append(f"{where}: an empty folder is left")
        if code == 0 and len(new) < len(complete):
            self.breaches.append(f"{where}: success without the files")
        if kind in ("size", "disk") and code not in (0, 5):
            self.breaches.append(f"{where}: neither 0 nor 5")
        if kind == "SIGTERM" and code not in (0, -signal.SIGTERM):
            self.breaches.append(f"{where}: neither 0 nor SIGTERM")

    def signalled(self, name, number):
        run, stood = self.fresh(name), self.random.random() < 0.5
        if stood:
            run.stand(self.complete[name])
        moment = self.random.uniform(0, 1.05 * self.seconds[name])
        process = run.start()
        try:
            process.communicate(timeout=moment)
        except subprocess.TimeoutExpired:
            process.send_signal(number)
            process.wait(60)
            process.stderr.close()
        self.check(name, run, signal.Signals(number).name, stood, process.returncode)
        shutil.rmtree(run.folder, ignore_errors=True)  # a killed program's gnuplot may write still

    def limited(self, name):
        run, stood = self.fresh(name), self.random.random() < 0.5
        if stood:
            run.stand(self.complete[name])
        process = run.start(limit=self.random.randint(0, int(1.05 * self.largest[name])))
        process.communicate(timeout=600)
        self.check(name, run, "size", stood, process.returncode)
        shutil.rmtree(run.folder)

    def full(self, name):
        """False where no file system can be mounted."""
        disk = self.top / "disk"
        disk.mkdir(exist_ok=True)
        pages = self.random.randint(2, 40)
        mount = ["mount", "-t", "tmpfs", "-o", f"size={4 * pages}k", "none", str(disk)]
        if subprocess.run(mount, stderr=subprocess.DEVNULL).returncode != 0:
            return False
        try:
            run, stood = self.fresh(name, disk), self.random.random() < 0.5
            if stood:
                try:
                    run.stand(self.complete[name])
                except OSError:  # not even these fit
                    return True
            process = run.start()
            process.communicate(timeout=600)
            self.check(name, run, "disk", stood, process.returncode)
        finally:
            subprocess.run(["umount", str(disk)], check=True)
        return True


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--moments", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", help="commands whose name holds this")
    arguments = parser.parse_args()
    names = [name for name in COMMANDS if arguments.only in name]
    if shutil.which("gnuplot") is None:
        drawn = ("report", "compare", "tradeoff", "fit page")
        names = [name for name in names if name not in drawn]
        print("without gnuplot: report, compare, tradeoff and the page of fit are left out")
    trial = Trial(os.path.abspath(arguments.program), arguments.seed)
    try:
        trial.prepare(names)
        trial.random.shuffle(names)
        for moment in range(arguments.moments):
            name = names[moment % len(names)]
            trial.signalled(name, signal.SIGTERM)
            trial.signalled(name, signal.SIGKILL)
            if moment % 3 == 0:
                name = names[moment // 3 % len(names)]
                trial.limited(name)
                if not trial.full(name) and moment == 0:
                    print("no tmpfs can be mounted here: full disks are left out")
    finally:
        shutil.rmtree(trial.top, ignore_errors=True)
    for breach in trial.breaches:
        print(breach)
    print(f"{len(names)} commands, seed {arguments.seed}, {len(trial.breaches)} breaches")
    for count in sorted(trial.counts):
        print(f"  {count}: {trial.counts[count]}")
    return 1 if trial.breaches else 0


if __name__ == "__main__":
    sys.exit(main())
