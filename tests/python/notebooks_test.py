"""notebooks_test.py NAME: a notebook is that of its source, runs, and shows what it should."""
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

FOLDER = Path(os.environ["HSHFIT_SOURCE"]) / "examples" / "notebooks"
SKIPPED = 77

try:
    import ipykernel  # noqa: F401
    import matplotlib  # noqa: F401
    import nbformat
    from nbconvert.preprocessors import ExecutePreprocessor
except ImportError as missing:
    print(f"skipped: {missing} (python3-nbconvert, python3-ipykernel, python3-matplotlib)")
    sys.exit(SKIPPED)

NAME = sys.argv.pop()


class Notebook(unittest.TestCase):
    def test_it_runs_without_an_error_and_shows_figures(self):
        subprocess.run([sys.executable, FOLDER / "make_notebooks.py", "--check"], check=True)
        notebook = nbformat.read(FOLDER / f"{NAME}.ipynb", as_version=4)
        with tempfile.TemporaryDirectory() as folder:
            ExecutePreprocessor(timeout=300).preprocess(notebook, {"metadata": {"path": folder}})
        outputs = [output for cell in notebook.cells if cell.cell_type == "code"
                   for output in cell.outputs]
        kinds = {kind for output in outputs for kind in output.get("data", {})}
        self.assertIn("image/png", kinds)
        self.assertIn("text/html", kinds)
        kept = os.environ.get("HSHFIT_NOTEBOOKS")
        if kept:
            Path(kept).mkdir(parents=True, exist_ok=True)
            nbformat.write(notebook, Path(kept) / f"{NAME}.ipynb")


if __name__ == "__main__":
    unittest.main(verbosity=2)
