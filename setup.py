"""The Python package hshfit for pip: the extension module is built by CMake.

HSHFIT_BUILD names a build folder that is configured with HSHFIT_PYTHON already, whose libraries are
used; without it, build-python is configured for this interpreter and everything is compiled.
"""
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

TOP = Path(__file__).resolve().parent
OWN = Path(os.environ.get("HSHFIT_BUILD") or TOP / "build-python").resolve()


class ByCMake(build_ext):
    """Builds the target of CMake and takes its files."""

    def build_extension(self, ext):
        if not (OWN / "CMakeCache.txt").exists():
            subprocess.run(
                ["cmake", "-S", TOP, "-B", OWN, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                 "-DHSHFIT_PYTHON=ON", "-DHSHFIT_TESTS=OFF", "-DHSHFIT_EXAMPLES=OFF",
                 "-DHSHFIT_INSTALL=OFF", "-DHSHFIT_UNITY=ON",
                 f"-DPython_EXECUTABLE={sys.executable}"], check=True)
        subprocess.run(["cmake", "--build", OWN, "--target", "hshfit_python_package"], check=True)
        for component in ("python", "python_pictures"):
            subprocess.run(["cmake", "--install", OWN, "--component", component, "--prefix",
                            OWN / "python-installed"], check=True)
        built = Path(self.get_ext_fullpath(ext.name))
        for file in (OWN / "python-installed").rglob("*.so"):
            built.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(file, built.parent / file.name)


def version():
    text = (TOP / "CMakeLists.txt").read_text(encoding="utf-8")
    return re.search(r"project\(hshfit VERSION ([0-9.]+)", text).group(1)


# setuptools' own folders lie in that of CMake, so that the source tree stays as it is.
OWN.mkdir(parents=True, exist_ok=True)
setup(
    version=version(),
    packages=["hshfit"],
    package_dir={"": "python"},
    package_data={"hshfit": ["py.typed", "*.pyi"]},
    ext_modules=[Extension("hshfit._hshfit", [])],
    cmdclass={"build_ext": ByCMake},
    options={"build": {"build_base": str(OWN / "wheel")},
             "egg_info": {"egg_base": str(OWN)}},
)
