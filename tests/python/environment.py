"""The virtual environment of docs/reference/python.md, in a folder with the files of the
checkout."""
import os
import re
import subprocess
import sys
from pathlib import Path

SOURCE = Path(os.environ["HSHFIT_SOURCE"])
FOLDER = Path(os.environ["HSHFIT_PROGRAM"]).parent / "python-environment"


def commands():
    """Lines of the page's sh blocks, without comments: the last one runs the notebooks."""
    page = (SOURCE / "docs" / "reference" / "python.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```sh\n(.*?)^```", page, re.DOTALL | re.MULTILINE)
    return [line.partition("  #")[0].strip() for block in blocks for line in block.splitlines()]


def run(command, **more):
    """In a shell, as a user without settings of their own whose python3 is this one."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    path = f"{Path(sys.executable).parent}:{kept['PATH']}"
    settings = {**kept, "PATH": path, "HOME": str(FOLDER / "home"), **more}
    done = subprocess.run(["sh", "-ec", command], cwd=FOLDER, check=False, capture_output=True,
                          text=True, env=settings)
    if done.returncode:
        raise AssertionError(f"{command}\n{done.stdout[-3000:]}{done.stderr[-3000:]}")
