"""The commands of docs/reference/python.md make a virtual environment with the package, without a
network."""
import os
import re
import shlex
import shutil
import subprocess
import unittest
from pathlib import Path

import environment

OUTSIDE = """
import hshfit, numpy
assert not hshfit.__file__.startswith({build!r}), hshfit.__file__
found = hshfit.project("lambert:kd=0.5", outgoing=4)
# 0.5 / pi against the first function of HSH, 1 / sqrt(2 pi) on the hemisphere.
first = 0.5 / numpy.pi * numpy.sqrt(2 * numpy.pi)
assert abs(found.coefficients.values[0, 0, 0] - first) < 1e-9
"""


class Install(unittest.TestCase):
    def state_of(self, source):
        """Untracked, ignored and changed files of a checkout."""
        if not (Path(source) / ".git").exists():
            return ""
        return subprocess.run(["git", "-C", source, "status", "--porcelain", "--ignored"],
                              check=True, capture_output=True, text=True).stdout

    def test_the_commands_of_the_page_then_import_and_project(self):
        build = Path(os.environ["HSHFIT_PROGRAM"]).parent
        source = environment.SOURCE
        before = self.state_of(source)
        # The folders and files of the checkout, without what is built there.
        shutil.rmtree(environment.FOLDER, ignore_errors=True)
        (environment.FOLDER / "home").mkdir(parents=True)
        for path in source.iterdir():
            if not re.match(r"build|out$|\.git$", path.name):
                (environment.FOLDER / path.name).symlink_to(path)
        configure, *commands = environment.commands()
        known = subprocess.run([source / "run", "help"], check=True, capture_output=True, text=True)
        self.assertIn(configure.split()[2], known.stdout)
        for command in commands[:-1]:
            environment.run(command, HSHFIT_BUILD=str(build), PIP_NO_INDEX="1")
        code = OUTSIDE.format(build=f"{build}/python/")
        environment.run(f"venv/bin/python -c {shlex.quote(code)}")
        # The source tree is as it was.
        self.assertEqual(before, self.state_of(source))


if __name__ == "__main__":
    try:
        import setuptools  # noqa: F401
        import venv  # noqa: F401
        import wheel  # noqa: F401
    except ImportError as missing:
        raise unittest.SkipTest(str(missing))
    unittest.main(verbosity=2)
