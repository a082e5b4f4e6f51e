#!/usr/bin/env python3
"""batch.py [HSHFIT]: the figures of docs/reference/batch.md, printed as Markdown. Takes some
minutes, and wants an idle machine.

1. 2,000 small projections: one process against two, and the overhead of an item.
2. A manifest of 100,000 lines: time and memory of its check.
3. 10,000 items of six commands: how evenly 64 shards share their measured processor times, by the
   estimates of the program and by the times of an earlier batch of other items.
4. Kills: 50 shards ended by SIGKILL at random moments, then run again."""
import csv
import json
import os
import random
import resource
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PROGRAM = str(Path(sys.argv[1] if len(sys.argv) > 1 else "build/hshfit").resolve())


def run(*words):
    answer = subprocess.run([PROGRAM, "batch", *map(str, words), "--json"], capture_output=True,
                            text=True)
    if answer.returncode not in (0, 4):
        sys.exit(answer.stderr)
    return json.loads(answer.stdout)


def material(draw):
    alpha = round(10 ** draw.uniform(-1.3, 0), 4)
    return draw.choice([
        f"ggx:alpha={alpha}", f"beckmann:alpha={alpha}", f"oren-nayar:kd=.5,sigma={alpha}",
        f"phong:exponent={round(2 / alpha ** 2, 3)}",
        f"lambert:kd=.4+ggx:alpha={alpha},F0={round(draw.random(), 3)}"])


def write(path, defaults, items):
    lines = [{"defaults": defaults}] if defaults else []
    path.write_text("".join(json.dumps(line) + "\n" for line in lines + items))


def times(folder, column="seconds"):
    with open(folder / "times.csv", encoding="ascii") as file:
        return {row["name"]: float(row[column]) for row in csv.DictReader(file)}


def small(count, seed):
    draw = random.Random(seed)
    return [{"input": material(draw), "name": f"m{i:06d}"} for i in range(count)]


PROJECT = {"command": "project", "options": {"order": 5, "outgoing": "16", "cosine": True}}


def speed(folder):
    write(folder / "small.jsonl", PROJECT, small(2000, 1))
    walls = {1: [], 2: []}
    for repeat in range(3):
        for threads in (1, 2):
            out = folder / f"small{threads}.{repeat}"
            walls[threads].append(run(folder / "small.jsonl", "-o", out, "--threads",
                                      threads)["seconds"])
    run(folder / "small.jsonl", "-o", folder / "small1.0", "--merge", "--thumbnails", 0)
    work = sum(times(folder / "small1.0").values())
    print("| 2,000 projections | seconds |\n|---|---|")
    print(f"| one process | {walls[1][0]:.2f}, {walls[1][1]:.2f}, {walls[1][2]:.2f} |")
    print(f"| two processes | {walls[2][0]:.2f}, {walls[2][1]:.2f}, {walls[2][2]:.2f} |")
    ratios = [a / b for a, b in zip(walls[1], walls[2])]
    print(f"| ratio, median and least | {statistics.median(ratios):.2f}, {min(ratios):.2f} |")
    print(f"| work by the items' own clocks | {work:.2f} |")
    print(f"| overhead of an item | {(walls[1][0] - work) / 2000 * 1e3:.2f} ms |\n")


def check(folder):
    write(folder / "large.jsonl", PROJECT, small(100_000, 2))
    start = time.time()
    subprocess.run([PROGRAM, "batch", folder / "large.jsonl", "--check", "--quiet"], check=True,
                   stdout=subprocess.DEVNULL)
    seconds = time.time() - start
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    print(f"Check of 100,000 lines: {seconds:.1f} s, at most {peak:.0f} MiB.\n")


def mixture(count, seed):
    draw = random.Random(seed)
    items = []
    for i in range(count):
        spec = material(draw)
        command = draw.choices(["project", "info", "eval", "compare", "render", "report"],
                               [50, 10, 10, 10, 10, 10])[0]
        item = {"command": command, "input": spec, "name": f"x{seed}-{i:05d}"}
        if command == "project":
            item["options"] = {"order": draw.choice([3, 5, 7, 9]), "outgoing": "16",
                               "cosine": True}
        elif command == "eval":
            item["options"] = {"wi": "30,0", "wo": "45,180"}
        elif command == "compare":
            item["with"] = "lambert"
        elif command == "render":
            item["options"] = {"size": 48}
        elif command == "report":
            item["options"] = {"max-order": 6, "cosine": True}
        items.append(item)
    return items


def balance(folder):
    for seed, count in ((3, 10_000), (4, 2000)):
        manifest = folder / f"mixture{seed}.jsonl"
        write(manifest, None, mixture(count, seed))
        run(manifest, "-o", folder / f"mixture{seed}")
        run(manifest, "-o", folder / f"mixture{seed}", "--merge", "--thumbnails", 0)
    measured = times(folder / "mixture3", "cpu_seconds")
    manifest = folder / "mixture3.jsonl"
    print("| costs | slowest of 64 shards over their mean |\n|---|---|")
    for name, costs in (("estimates", []), ("times of 2,000 other items",
                                            ["--costs", folder / "mixture4" / "times.csv"]),
                        ("times of the same items",
                         ["--costs", folder / "mixture3" / "times.csv"])):
        sums = []
        for k in range(1, 65):
            names = run(manifest, "--check", "--list", "--shard", f"{k}/64", *costs)["names"]
            sums.append(sum(measured[each] for each in names))
        print(f"| {name} | {max(sums) / statistics.mean(sums):.3f} |")
    print(f"\nItems took {min(measured.values()) * 1e3:.1f} to "
          f"{max(measured.values()) * 1e3:.0f} ms, {sum(measured.values()):.1f} s in all.\n")


def kills(folder):
    manifest = folder / "small.jsonl"
    write(manifest, PROJECT, small(2000, 1))
    draw = random.Random(5)
    out, done, killed = folder / "killed", 0, 0
    while killed < 50:
        shard = draw.randint(1, 8)
        process = subprocess.Popen([PROGRAM, "batch", manifest, "-o", out, "--shard",
                                    f"{shard}/8", "--quiet"], stdout=subprocess.DEVNULL)
        time.sleep(draw.uniform(.02, .4))
        process.send_signal(signal.SIGKILL)
        killed += process.wait() == -signal.SIGKILL
        now = run(manifest, "-o", out, "--status")["done"]
        assert now >= done, "a result was lost"
        done = now
    last = run(manifest, "-o", out)
    assert last["done"] == 2000 and last["kept"] >= done
    hidden = [path for path in (out / "items").iterdir() if path.name.startswith(".")]
    assert not hidden and not list((out / "running").iterdir())
    run(manifest, "-o", out, "--merge", "--thumbnails", 0)
    reference = folder / "small1.0"
    for name in ("table.csv", "table.jsonl", "index.html"):
        assert (out / name).read_bytes() == (reference / name).read_bytes(), name
    print(f"After {killed} kills {done} of 2,000 items stood; the next run made the rest, no part "
          "of an item was left, and the table has the bytes of a run without kills.")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as name:
        os.environ.pop("SLURM_ARRAY_TASK_ID", None)
        for part in (speed, check, balance, kills):
            part(Path(name))
            sys.stdout.flush()
