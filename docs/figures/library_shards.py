#!/usr/bin/python3
"""library_shards.py PROGRAM OUT COUNT [--shards N,...] [--pictures]

The cost of learning COUNT made materials, sums of lambert and ggx with numbers drawn at random: for
each number of shards the CPU seconds and the largest memory of `library learn` and `library
merge`, and whether the bytes are those of the first. --pictures: with the limit of FLIP.
"""
import argparse
import hashlib
import pathlib
import random
import subprocess
import sys


def materials(count):
    drawn = random.Random(1)
    for n in range(count):
        kd = "/".join(f"{drawn.random() ** 2 * 0.8:.4f}" for _ in range(3))
        alpha, f0 = 0.05 + 0.6 * drawn.random() ** 2, 0.02 + 0.2 * drawn.random() ** 3
        yield f"lambert:kd={kd} + ggx:alpha={alpha:.6f},F0={f0:.6f}"


# A process begins with the memory of the one that it is forked from, so that the program is started
# by a small one.
MEASURED = """
import os, subprocess, sys
with subprocess.Popen(sys.argv[1:], stdout=subprocess.DEVNULL) as process:
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
print(process.returncode, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024)
"""


def run(*words):
    """CPU seconds and the largest memory in megabytes."""
    words = [str(word) for word in words]
    answer = subprocess.run([sys.executable, "-c", MEASURED, *words], stdout=subprocess.PIPE,
                            check=True, text=True).stdout.split()
    if answer[0] != "0":
        raise SystemExit(f"{' '.join(words)[:200]}: exit code {answer[0]}")
    return float(answer[1]), float(answer[2])


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("out")
    parser.add_argument("count", type=int)
    parser.add_argument("--shards", default="1,2,8")
    parser.add_argument("--pictures", action="store_true")
    arguments = parser.parse_args()
    out = pathlib.Path(arguments.out)
    out.mkdir(parents=True, exist_ok=True)
    specs = list(materials(arguments.count))
    limits = () if arguments.pictures else ("--limit-flip", 1)
    first = None
    print("| shards | learn, CPU s a material | merge, CPU s a material | MB, learn | MB, merge |"
          " library, kB a material | bytes |\n|---|---|---|---|---|---|---|")
    for shards in map(int, arguments.shards.split(",")):
        costs, paths = [], []
        for k in range(shards):
            paths.append(out / f"part-{k}.library")
            costs.append(run(arguments.program, "library", "learn", *specs[k::shards], *limits,
                             "-o", paths[-1], "--force", "--quiet"))
        merged, cost = paths[0], (0, 0)
        if shards > 1:
            merged = out / "whole.library"
            cost = run(arguments.program, "library", "merge", *paths, "-o", merged, "--force",
                       "--quiet")
        whole = merged.read_bytes()
        known = hashlib.sha256(whole).hexdigest()
        first = first or known
        print(f"| {shards} | {sum(c[0] for c in costs) / len(specs):.3f} | "
              f"{cost[0] / len(specs):.3f} | {max(c[1] for c in costs):.0f} | {cost[1]:.0f} | "
              f"{len(whole) / 1e3 / len(specs):.2f} | {'same' if known == first else 'OTHERS'} |",
              flush=True)


if __name__ == "__main__":
    main()
