#!/usr/bin/env python3
"""quoted_answers.py PROGRAM PAGE…: whether answers that pages quote are those of the program.

A quoted command is a line "$ hshfit …" in a block, fenced or indented; the lines below it, up to
the next command or the end of the block, are parts of its answer. The commands of a page that have
such lines, and those of the same block before them, run in their order in one empty folder that has
examples/. Each quoted line has to appear in the answer, numbers within a fiftieth; numbers below
1e-5 are rounding, and only have to be there. A line with an ellipsis is left out.

Prints each breach as page:line and ends with 1 if there is one, or if a page quotes nothing.
"""
import re
import subprocess
import sys
from pathlib import Path

from page_folder import TOP, page_folder

NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.]*[a-zA-Z_])")


def blocks(page):
    """(number of the first line, lines) of each fenced or indented block."""
    found, fenced, block = [], False, None
    for at, line in enumerate(page.read_text(encoding="utf-8").split("\n"), 1):
        if line.startswith("```"):
            fenced, block = not fenced, None
            if fenced:
                block = (at + 1, [])
                found.append(block)
        elif fenced:
            block[1].append(line)
        elif line.startswith("    "):
            if block is None:
                block = (at, [])
                found.append(block)
            block[1].append(line[4:])
        else:
            block = None
    return found


def quotations(lines):
    """[(command, [(offset, line of the answer)])] of a block, up to the last that is answered."""
    commands = []
    for offset, line in enumerate(lines):
        if line.startswith("$ "):
            commands.append((line[2:] if line.startswith("$ hshfit ") else "true", []))
        elif commands and line.strip() and "…" not in line:
            commands[-1][1].append((offset, line))
    while commands and not commands[-1][1]:
        commands.pop()
    return commands


def parts(text):
    """The words and the numbers of a line; spaces do not matter."""
    squeezed = " ".join(text.split())
    return NUMBER.sub("#", squeezed), [float(one) for one in NUMBER.findall(squeezed)]


def same(quoted, said):
    words, numbers = parts(quoted)
    said_words, said_numbers = parts(said)
    return words == said_words and len(numbers) == len(said_numbers) and all(
        abs(one - other) <= 0.02 * abs(other) or max(abs(one), abs(other)) < 1e-5
        for one, other in zip(numbers, said_numbers))


def check_page(program, page):
    quoted = 0
    with page_folder(program, 1000) as (folder, env):
        for start, lines in blocks(page):
            for command, answer in quotations(lines):
                done = subprocess.run(["bash", "-c", command], cwd=folder, env=env, text=True,
                                      stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                      stderr=subprocess.STDOUT, check=False)
                said = done.stdout.split("\n")
                for offset, line in answer:
                    quoted += 1
                    if not any(same(line, one) for one in said):
                        yield (f"{page}:{start + offset}: '{command}' does not answer "
                               f"'{line.strip()}', but:\n{done.stdout}")
    if not quoted:
        yield f"{page}: no answer is quoted"


def main():
    if len(sys.argv) < 3:
        sys.exit("usage: quoted_answers.py PROGRAM PAGE…")
    program = Path(sys.argv[1]).resolve()
    found = [breach for name in sys.argv[2:] for breach in check_page(program, Path(name))]
    print("\n".join(found), end="\n" if found else "")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
