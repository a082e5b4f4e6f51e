#!/usr/bin/env python3
"""cluster_files.py PROGRAM: the ready files for clusters and containers fit the program.

YAML parses and describes an indexed Job whose shares add up; every `hshfit` command line in
examples/batch and packaging/container has a command and options that the program takes; the files
that cannot run here say so; examples/batch/parallel.sh, where GNU parallel is there, gives the
table of one process.
"""
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PROGRAM = Path(sys.argv[1]).resolve()
MANIFEST = ROOT / "examples/batch/materials.jsonl"
SKIPPED = 77


def run(words, **more):
    return subprocess.run([PROGRAM, *words], capture_output=True, text=True, **more)


def options_of(command):
    """The long and short options in the help of a command."""
    answer = run([command, "--help"])
    assert answer.returncode == 0, f"{command} is no command"
    return set(re.findall(r"(?<![\w-])--?[a-z][\w-]*", answer.stdout))


def check_words(words, where):
    """A command line, without the name of the program."""
    known = options_of(words[0])
    for word in words[1:]:
        option = word.split("=")[0]
        if re.match(r"--?[a-z]", option):
            assert option in known, f"{where}: {words[0]} has no option {option}"


def command_lines(text):
    """The words after `hshfit` of every command line, also of those in comments."""
    for line in text.replace("\\\n", " ").splitlines():
        line = line.lstrip("# ")
        found = re.search(r"(?:^|[\s;|&])hshfit(?::[\d.]+)? (?=[a-z]+ )(.*)", line)
        if found and not line.startswith(("apt", "The ", "podman build")):
            yield shlex.split(found.group(1))


def check_kubernetes(yaml):
    text = (ROOT / "examples/batch/kubernetes.yaml").read_text()
    job = yaml.safe_load(text)
    spec, pod = job["spec"], job["spec"]["template"]["spec"]
    assert (job["apiVersion"], job["kind"]) == ("batch/v1", "Job")
    # The program reads the number of the share from JOB_COMPLETION_INDEX, of an indexed Job alone.
    assert spec["completionMode"] == "Indexed"
    assert pod["restartPolicy"] in ("OnFailure", "Never")
    container = pod["containers"][0]
    words = container["args"]
    assert all(isinstance(word, str) for word in words), "YAML turned an argument into a number"
    check_words(words, "kubernetes.yaml")
    assert words[words.index("--shard") + 1] == f"/{spec['completions']}"
    mounts = {mount["name"] for mount in container["volumeMounts"]}
    assert mounts == {volume["name"] for volume in pod["volumes"]}
    # The command line as the program takes it, with the share that Kubernetes would state.
    words = [str(MANIFEST) if word == "/data/materials.jsonl" else word for word in words]
    words = ["batch-folder" if word == "/data/batch" else word for word in words]
    with tempfile.TemporaryDirectory() as folder:
        for index in range(spec["completions"]):
            answer = run([*words, "--check"], cwd=folder,
                         env={**os.environ, "JOB_COMPLETION_INDEX": str(index)})
            assert answer.returncode == 0, answer.stderr
        beyond = run([*words, "--check"], cwd=folder,
                     env={**os.environ, "JOB_COMPLETION_INDEX": str(spec["completions"])})
        assert beyond.returncode == 2, "an index beyond the completions passes"


def check_lines():
    files = [*(ROOT / "examples/batch").iterdir(), *(ROOT / "packaging/container").iterdir()]
    lines = 0
    for path in files:
        for words in command_lines(path.read_text()):
            check_words(words, path.name)
            lines += 1
    assert lines >= 6, f"only {lines} command lines found"


def check_labels():
    containers = (ROOT / "packaging/container").iterdir()
    for path in [ROOT / "examples/batch/kubernetes.yaml", *containers]:
        assert "Not run" in path.read_text(), f"{path} does not say that it was not run"


def check_parallel():
    """Says so and returns False where GNU parallel is absent."""
    if not shutil.which("parallel"):
        print("GNU parallel is absent: parallel.sh was not run")
        return False
    with tempfile.TemporaryDirectory() as folder:
        paths = {**os.environ, "PATH": f"{PROGRAM.parent}:{os.environ['PATH']}"}
        script = ROOT / "examples/batch/parallel.sh"
        subprocess.run([script, MANIFEST, f"{folder}/shares", "3", "--will-cite"], env=paths,
                       check=True, capture_output=True)
        for more in [], ["--merge"]:
            assert run(["batch", MANIFEST, "-o", f"{folder}/one", *more]).returncode == 0
        for name in "table.csv", "table.jsonl":
            shared, alone = (Path(folder, at, name).read_bytes() for at in ("shares", "one"))
            assert shared == alone, f"{name} differs between three shares and one process"
    return True


def main():
    check_lines()
    check_labels()
    try:
        import yaml
    except ImportError:
        print("python3-yaml is absent: kubernetes.yaml was not checked")
        return SKIPPED
    check_kubernetes(yaml)
    return 0 if check_parallel() else SKIPPED


if __name__ == "__main__":
    sys.exit(main())
