"""pip installs the package into a virtual environment without a network, from outside."""
import os
import subprocess
import sys
import unittest
from pathlib import Path

import program

OUTSIDE = """
import hshfit, numpy
assert not hshfit.__file__.startswith({build!r}), hshfit.__file__
found = hshfit.project("lambert:kd=0.5", outgoing=4)
# 0.5 / pi against the first function of HSH, 1 / sqrt(2 pi) on the hemisphere.
first = 0.5 / numpy.pi * numpy.sqrt(2 * numpy.pi)
assert abs(found.coefficients.values[0, 0, 0] - first) < 1e-9
"""


class Install(program.InFolder):
    def run_in(self, *words, **environment):
        kept = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        done = subprocess.run(words, check=False, capture_output=True, text=True,
                              env={**kept, **environment})
        self.assertEqual(done.returncode, 0, done.stdout[-3000:] + done.stderr[-3000:])
        return done.stdout

    def state_of(self, source):
        """Untracked, ignored and changed files of a checkout."""
        if not (Path(source) / ".git").exists():
            return ""
        return self.run_in("git", "-C", source, "status", "--porcelain", "--ignored")

    def test_pip_install_then_import_and_project(self):
        build = Path(os.environ["HSHFIT_PROGRAM"]).parent
        source = os.environ["HSHFIT_SOURCE"]
        before = self.state_of(source)
        self.run_in(sys.executable, "-m", "venv", "--system-site-packages", "venv")
        self.run_in("venv/bin/python", "-m", "pip", "install", "--no-build-isolation",
                    "--no-index", "--no-deps", source, HSHFIT_BUILD=str(build))
        self.run_in("venv/bin/python", "-c", OUTSIDE.format(build=str(build)))
        # The source tree is as it was.
        self.assertEqual(before, self.state_of(source))


if __name__ == "__main__":
    try:
        import setuptools  # noqa: F401
        import venv  # noqa: F401
        import wheel  # noqa: F401
    except ImportError as missing:
        raise unittest.SkipTest(str(missing))
    program.main()
