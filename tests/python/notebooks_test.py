"""notebooks_test.py NAME: a notebook is that of its source, runs in the environment of
install_test.py by the command of docs/reference/python.md, and shows what it should."""
import json
import subprocess
import sys
import unittest

import environment

SKIPPED = 77

try:
    import ipykernel  # noqa: F401
    import matplotlib  # noqa: F401
    import nbconvert  # noqa: F401
except ImportError as missing:
    print(f"skipped: {missing} (python3-nbconvert, python3-ipykernel, python3-matplotlib)")
    sys.exit(SKIPPED)

NAME = sys.argv.pop()


class Notebook(unittest.TestCase):
    def test_it_runs_without_an_error_and_shows_figures(self):
        subprocess.run([sys.executable, environment.SOURCE / "examples" / "notebooks" /
                        "make_notebooks.py", "--check"], check=True)
        command = environment.commands()[-1]
        environment.run(command.replace("*.ipynb", f"{NAME}.ipynb"))
        result = environment.FOLDER / "out" / "notebooks" / f"{NAME}.ipynb"
        notebook = json.loads(result.read_text(encoding="utf-8"))
        kinds = {kind for cell in notebook["cells"] for output in cell.get("outputs", [])
                 for kind in output.get("data", {})}
        self.assertIn("image/png", kinds)
        self.assertIn("text/html", kinds)


if __name__ == "__main__":
    unittest.main(verbosity=2)
