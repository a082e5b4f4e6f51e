#!/usr/bin/python3
"""make_notebooks.py [--check]: NAME.ipynb from each NAME.py beside this script.

The cells of a source begin with "# %%", those of text with "# %% [markdown]". Notebooks are written
without results; with --check nothing is written, and a notebook that differs ends it with 1.
"""
import sys
from pathlib import Path

import nbformat
from nbformat import v4

FOLDER = Path(__file__).resolve().parent
NAMES = ["first_steps", "figures_of_the_paper", "choose_a_basis", "fit_with_uncertainties",
         "brdf_of_your_own"]


def cells_of(source):
    for part in source.split("# %%")[1:]:
        head, _, body = part.partition("\n")
        body = body.strip()
        if head.strip() == "[markdown]":
            lines = [line.removeprefix("#").removeprefix(" ") for line in body.split("\n")]
            yield v4.new_markdown_cell("\n".join(lines))
        else:
            yield v4.new_code_cell(body)


def notebook_of(name):
    source = (FOLDER / f"{name}.py").read_text(encoding="utf-8")
    cells = list(cells_of(source))
    for number, cell in enumerate(cells):
        cell["id"] = f"{name.replace('_', '-')}-{number}"  # the same in every run
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    notebook = v4.new_notebook(cells=cells, metadata={"kernelspec": kernel})
    nbformat.validate(notebook)
    return nbformat.writes(notebook, indent=1) + "\n"


def main():
    check = sys.argv[1:] == ["--check"]
    stale = []
    for name in NAMES:
        path = FOLDER / f"{name}.ipynb"
        text = notebook_of(name)
        if check and (not path.exists() or path.read_text(encoding="utf-8") != text):
            stale.append(path.name)
        elif not check:
            path.write_text(text, encoding="utf-8")
    if stale:
        sys.exit(f"make_notebooks: {', '.join(stale)} differ from their sources; run it again")


if __name__ == "__main__":
    main()
