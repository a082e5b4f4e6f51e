"""Recipe for Conan 2. Conan itself was not run; docs/install.md says which steps were.
    conan create packaging/conan --build=missing [-o "&:parts=math|files"]
"""
import re
from pathlib import Path

from conan import ConanFile
from conan.tools.build import check_min_cppstd
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy

TOP = Path(__file__).resolve().parent.parent.parent


class Hshfit(ConanFile):
    name = "hshfit"
    description = "BRDFs as coefficients of hemispherical harmonics and of competing bases"
    license = "BSD-3-Clause"
    settings = "os", "compiler", "build_type", "arch"
    package_type = "static-library"
    # system: the packages of the operating system, found by their own CMake packages.
    options = {"parts": ["math", "files"], "system": [True, False]}
    default_options = {"parts": "files", "system": False}

    def set_version(self):
        text = (TOP / "CMakeLists.txt").read_text()
        self.version = re.search(r"project\(hshfit VERSION ([\d.]+)", text).group(1)

    def export_sources(self):
        for pattern in ("CMakeLists.txt", "LICENSE", "README.md", "CHANGELOG.md", "cmake/*",
                        "lib/*", "docs/*.md", "docs/schemas/*", "examples/*"):
            copy(self, pattern, TOP, self.export_sources_folder)

    def requirements(self):
        if self.options.system:
            return
        for package in ("eigen/3.4.0", "fmt/9.1.0", "onetbb/2021.10.0", "highway/1.0.3",
                        "imath/3.1.9", "zstd/1.5.5"):
            self.requires(package)
        if self.options.parts == "files":
            for package in ("openexr/3.2.1", "nlohmann_json/3.11.2", "libpng/1.6.40",
                            "zlib/1.3.1", "openimageio/2.4.7.1", "nettle/3.8.1",
                            "kainjow-mustache/4.1"):
                self.requires(package)

    def validate(self):
        check_min_cppstd(self, 20)

    def layout(self):
        cmake_layout(self)

    def generate(self):
        toolchain = CMakeToolchain(self)
        toolchain.variables["HSHFIT_PARTS"] = str(self.options.parts)
        toolchain.variables["HSHFIT_TESTS"] = False
        toolchain.variables["HSHFIT_EXAMPLES"] = False
        toolchain.generate()
        CMakeDeps(self).generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        CMake(self).install()

    def package_info(self):
        # The package's own files for CMake name its targets and what they link.
        self.cpp_info.set_property("cmake_find_mode", "none")
        self.cpp_info.builddirs.append("lib/cmake/hshfit")
