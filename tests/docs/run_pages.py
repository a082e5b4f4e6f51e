#!/usr/bin/env python3
"""run_pages.py PROGRAM PAGE…: runs the commands of pages as a reader would.

The ```sh blocks of a page run in order, by bash with -euo pipefail, in one empty folder that has
the scenes of examples/ and the program on the PATH, as hshfit. A ```text block below holds lines of
the answer: each line has to appear in the output of the block above, spaces aside; lines with an
ellipsis are left out.

A block whose first line is a comment that begins with "Not run" is not run. Its syntax is checked,
and that its commands of ./run and of hshfit, its scripts and its folders exist.

Prints each breach as page:line and ends with 1 if there is one.

run_pages.py --script PAGE: prints the blocks that are run, as one script for bash, to run them on
another machine, where the program is installed. With the language of other blocks, as in
`run_pages.py --script docs/reference/library.md cmake`, prints these.
"""
import re
import subprocess
import sys
import time
from pathlib import Path

from page_folder import TOP, page_folder


def blocks(page):
    """(line, language, text) of each fenced block."""
    lines = page.read_text(encoding="utf-8").split("\n")
    start, kind = None, None
    for at, line in enumerate(lines):
        if not line.startswith("```"):
            continue
        if start is None:
            start, kind = at + 1, line[3:].strip()
        else:
            yield start + 1, kind, "\n".join(lines[start:at])
            start = None


def is_unrun(text):
    return re.match(r"#+ Not run", text)


def script(page, language="sh"):
    """The blocks of a page in a language; those in sh that are run."""
    return "\n".join(["set -euo pipefail"] * (language == "sh") +
                     [text for _, kind, text in blocks(page)
                      if kind == language and not is_unrun(text)])


def answer(program, *words):
    return subprocess.run([program, *words], capture_output=True, text=True, check=False)


def check_unrun(program, text):
    """Breaches of a block that is not run."""
    checked = subprocess.run(["bash", "-n"], input=text, capture_output=True, text=True,
                             check=False)
    if checked.returncode:
        yield checked.stderr.strip()
    known = re.findall(r"^  ([a-z]+) ", answer(TOP / "run", "help").stdout, re.MULTILINE)
    for name in re.findall(r"^(?:\S+=\S+ )*\./run ([a-z]+)", text, re.MULTILINE):
        if name not in known:
            yield f"./run has no command {name}"
    for name in re.findall(r"^hshfit ([a-z]+)", text, re.MULTILINE):
        if answer(program, "help", name).returncode:
            yield f"hshfit has no command {name}"
    for name in re.findall(r"(?<![\w/])((?:tests|docs|examples)/[\w./-]*|examples)", text):
        if not (TOP / name).exists():
            yield f"there is no {name}"


def squeezed(text):
    return re.sub(r"\s+", " ", text).strip()


def run_page(program, page):
    """Breaches of a page."""
    ran = 0
    with page_folder(program, 100) as (folder, env):
        output = ""
        for line, kind, text in blocks(page):
            if kind == "sh" and is_unrun(text):
                for breach in check_unrun(program, text):
                    yield f"{page}:{line}: {breach}"
            elif kind == "sh":
                start = time.monotonic()
                done = subprocess.run(["bash", "-euo", "pipefail", "-c", text], cwd=folder, env=env,
                                      stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                      stderr=subprocess.STDOUT, text=True, check=False)
                output = done.stdout
                ran += 1
                print(f"{page}:{line}: {time.monotonic() - start:.1f} s", flush=True)
                if done.returncode:
                    yield f"{page}:{line}: exit code {done.returncode}\n{output}"
            elif kind == "text" and output:
                said = squeezed(output)
                for offset, expected in enumerate(text.split("\n")):
                    if "…" not in expected and squeezed(expected) not in said:
                        yield (f"{page}:{line + offset}: the program does not answer "
                               f"'{squeezed(expected)}', but:\n{output}")
    if not ran:
        yield f"{page}: no block was run"


def main():
    if len(sys.argv) < 3:
        sys.exit("usage: run_pages.py PROGRAM PAGE…, or run_pages.py --script PAGE [LANGUAGE]")
    if sys.argv[1] == "--script":
        print(script(Path(sys.argv[2]), *sys.argv[3:]))
        return 0
    program = Path(sys.argv[1]).resolve()
    found = [breach for name in sys.argv[2:] for breach in run_page(program, Path(name))]
    print("\n".join(found), end="\n" if found else "")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
