"""Signatures of functions that take options of jobs, in the stubs, from their docstrings.

    stub_signatures.py --update    writes them to python/hshfit/__init__.pyi
"""
import re
import sys
from pathlib import Path

import hshfit

SOURCE = Path(__file__).parents[2] / "python" / "hshfit" / "__init__.pyi"


def signature(doc, name):
    """The lines of a stub, one for each argument; None for other functions, whose signatures are
    those of pybind11 and know of objects alone."""
    found = re.match(rf"{name}\((.*, \*, .*)\) -> (.+)\n", doc)
    if not found or ": object" in found[1]:
        return None
    arguments = re.split(r", (?=\w+: |\*)", found[1])
    lines = [re.sub(r" = .*", " = ...", argument) for argument in arguments]
    return "".join([f"def {name}(\n", *(f"    {line},\n" for line in lines),
                    f") -> {found[2]}: ...\n"])


def updated(stubs):
    """The text of the stubs with these signatures as they are."""
    for name in hshfit.__all__:
        lines = signature(getattr(hshfit, name).__doc__ or "", name)
        if lines:
            stubs = re.sub(rf"(?ms)^def {name}\(.*?\) -> [^\n]*: \.\.\.\n",
                           lambda _, lines=lines: lines, stubs)
    return stubs


if __name__ == "__main__":
    if sys.argv[1:] != ["--update"]:
        sys.exit(__doc__)
    SOURCE.write_text(updated(SOURCE.read_text(encoding="utf-8")), encoding="utf-8")
