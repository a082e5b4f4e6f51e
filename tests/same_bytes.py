#!/usr/bin/env python3
"""same_bytes.py OLD [PATTERN]: holds that build/hshfit writes what the program OLD wrote.

While it works, build/hshfit is a shim: each command of the demonstration and of the tests that run
the program, or with PATTERN (a regular expression of ctest) of those tests alone, is run by OLD
twice and by build/hshfit once, each time from the same state of the files. Exit code, standard
output, standard error and every file have to be the same byte for byte. Parts in which the two runs
of OLD differ, such as measured times, are counted and not compared. Prints each difference, then
the counts; ends with 1 if there is a difference.
"""
import hashlib
import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

TOP = Path(__file__).resolve().parent.parent
PROGRAM = TOP / "build" / "hshfit"
TESTS = r"^(Cli|Export|Fit|Form|Import|ManyInputs|PlanCommand|TradeoffCommand)\.|RealFiles"


def state_of(folders):
    """Relative path -> hash of the contents, for every file under the folders."""
    found = {}
    for folder in folders:
        for path in sorted(Path(folder).rglob("*")):
            if path.is_symlink():
                found[str(path)] = "link to " + os.readlink(path)
            elif path.is_file():
                found[str(path)] = hashlib.sha256(path.read_bytes()).hexdigest()
    return found


def restore(folders, kept):
    """Files keep their inodes, since the shell of a command may have one of them open."""
    for number, folder in enumerate(folders):
        source = Path(kept) / str(number)
        for path in sorted(Path(folder).rglob("*"), reverse=True):
            if path.is_symlink() or not os.path.lexists(source / path.relative_to(folder)):
                path.rmdir() if path.is_dir() and not path.is_symlink() else path.unlink()
        shutil.copytree(source, folder, symlinks=True, dirs_exist_ok=True, copy_function=put)


def put(source, target):
    """Copies a file unless the target has its bytes and its times."""
    if not os.path.isfile(target) or Path(target).read_bytes() != Path(source).read_bytes():
        shutil.copyfile(source, target)
    shutil.copystat(source, target)


def answer(program, arguments, folders, stdin):
    done = subprocess.run([program, *arguments], input=stdin, capture_output=True, check=False)
    parts = {"exit code": done.returncode, "standard output": done.stdout.decode("latin-1"),
             "standard error": done.stderr.decode("latin-1")}
    parts.update(state_of(folders))
    return done, parts


def shim(arguments):
    """What build/hshfit does while the check runs."""
    new, old = os.environ["SAME_BYTES_NEW"], os.environ["SAME_BYTES_OLD"]
    if resource.getrlimit(resource.RLIMIT_FSIZE)[0] != resource.RLIM_INFINITY:
        os.execv(new, [new, *arguments])  # copies cannot be made under that limit
    folders = [f for f in os.environ["SAME_BYTES_FOLDERS"].split(":") if os.path.isdir(f)]
    stdin = b""
    with tempfile.TemporaryDirectory(dir=os.environ["SAME_BYTES_WORK"]) as kept:
        for number, folder in enumerate(folders):
            shutil.copytree(folder, Path(kept) / str(number), symlinks=True)
        runs = []
        for program in (old, old, new):
            restore(folders, kept)
            done, parts = answer(program, arguments, folders, stdin)
            runs.append(parts)
    differ, vary = [], []
    for part in sorted(set(runs[0]) | set(runs[1]) | set(runs[2])):
        first, second, third = (run.get(part) for run in runs)
        if first != second:
            vary.append(part)
        elif first != third:
            differ.append(part)
    with open(os.environ["SAME_BYTES_LOG"], "a", encoding="utf-8") as log:
        log.write(json.dumps({"command": arguments, "differ": differ, "vary": vary,
                              "parts": len(runs[2])}) + "\n")
    sys.stdout.buffer.write(done.stdout)
    sys.stderr.buffer.write(done.stderr)
    sys.exit(done.returncode if done.returncode >= 0 else 128 - done.returncode)


def check(old, pattern):
    work = Path(tempfile.mkdtemp(prefix="same_bytes."))
    new, log, temporary = work / "new", work / "log", work / "tmp"
    temporary.mkdir()
    log.touch()
    (TOP / "out").mkdir(exist_ok=True)
    shutil.copy2(PROGRAM, new)
    environment = {**os.environ, "TMPDIR": str(temporary), "SAME_BYTES_OLD": str(old),
                   "SAME_BYTES_NEW": str(new), "SAME_BYTES_LOG": str(log),
                   "SAME_BYTES_WORK": str(work), "SAME_BYTES_FOLDERS": f"{temporary}:{TOP / 'out'}"}
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # the program is put back
    # A new file in place of the program, so that a running copy is not written over.
    PROGRAM.unlink()
    script = Path(__file__).resolve()
    PROGRAM.write_text(f'#!/bin/sh\nexec /usr/bin/python3 "{script}" --shim "$@"\n')
    PROGRAM.chmod(0o755)
    try:
        for steps in () if pattern else ("demo.sh", "demo_wings.sh"):
            subprocess.run([TOP / "examples" / steps], env=environment, check=False,
                           stdout=subprocess.DEVNULL)
        subprocess.run(["ctest", "--preset", "release", "-R", pattern or TESTS], cwd=TOP,
                       env=environment, check=False, stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL)
    finally:
        PROGRAM.unlink()
        shutil.copy2(new, PROGRAM)
    rows = [json.loads(line) for line in log.read_text().splitlines()]
    for row in rows:
        for part in row["differ"]:
            print(f"differs: {part}: hshfit {' '.join(row['command'])}")
    different = sum(bool(row["differ"]) for row in rows)
    print(f"same_bytes: {len(rows)} commands, {sum(row['parts'] for row in rows)} parts (exit"
          f" codes, outputs, files); {sum(len(row['vary']) for row in rows)} parts vary in OLD"
          f" itself; {different} commands differ")
    shutil.rmtree(work)
    return 1 if different or not rows else 0


if __name__ == "__main__":
    if sys.argv[1:2] == ["--shim"]:
        shim(sys.argv[2:])
    sys.exit(check(Path(sys.argv[1]).resolve(), sys.argv[2] if len(sys.argv) > 2 else ""))
