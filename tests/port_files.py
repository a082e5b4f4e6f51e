#!/usr/bin/env python3
"""port_files.py: the port for vcpkg and the recipe for Conan fit their formats and the project.

The manifest keeps the rules of vcpkg's JSON schema that apply to it (docs/vcpkg.schema.json of
vcpkg-tool). The recipe is run, with classes in place of Conan's own: its version is that of
CMakeLists.txt, its requirements are NAME/VERSION, and each pattern that it exports names files.
Both set only options that CMakeLists.txt has, and ask for the same libraries. Neither vcpkg nor
Conan is run.
"""
import json
import re
import sys
import tempfile
import types
from pathlib import Path

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parents[1]
CMAKE = (ROOT / "CMakeLists.txt").read_text()
VERSION = re.search(r"project\(hshfit VERSION ([\d.]+)", CMAKE).group(1)
OPTIONS = set(re.findall(r"\b(?:option|set)\((HSHFIT_\w+)", CMAKE))
IDENTIFIER = re.compile(r"[a-z0-9]+(-[a-z0-9]+)*")
# The names of vcpkg by those of Conan, where they differ.
VCPKG_NAMES = {"eigen": "eigen3", "onetbb": "tbb", "nlohmann_json": "nlohmann-json"}


def check_dependency(dependency):
    """The name of a dependency of vcpkg."""
    if isinstance(dependency, str):
        dependency = {"name": dependency}
    unknown = set(dependency) - {"name", "features", "host", "default-features", "platform",
                                 "version>="}
    assert not unknown, f"vcpkg.json: a dependency has no {unknown}"
    for name in [dependency["name"], *dependency.get("features", [])]:
        assert IDENTIFIER.fullmatch(name), f"vcpkg.json: {name} is no identifier"
    return dependency["name"]


def check_vcpkg():
    """Names of libraries for `math` and for `files`."""
    port = json.loads((ROOT / "packaging/vcpkg/vcpkg.json").read_text())
    known = {"name", "version-semver", "description", "license", "supports", "dependencies",
             "features"}
    unknown = {key for key in port if not key.startswith("$")} - known
    assert not unknown, f"vcpkg.json: {unknown} is unknown here"
    assert port["version-semver"] == VERSION
    assert IDENTIFIER.fullmatch(port["name"])
    names = {"math": [check_dependency(one) for one in port["dependencies"]]}
    for name, feature in port["features"].items():
        assert IDENTIFIER.fullmatch(name) and feature["description"]
        assert set(feature) <= {"description", "dependencies", "supports"}
        names[name] = [check_dependency(one) for one in feature["dependencies"]]
    text = (ROOT / "packaging/vcpkg/portfile.cmake").read_text()
    check_options(text, "portfile.cmake")
    for feature in re.findall(r'"(\w+)" IN_LIST FEATURES', text):
        assert feature in port["features"], f"portfile.cmake: no feature {feature}"
        assert re.search(rf'MATCHES "\^?\(?[\w|]*{feature}', CMAKE)
    return {part: {one for one in names[part] if not one.startswith("vcpkg-")}
            for part in ("math", "files")}


def check_options(text, where):
    for option in re.findall(r"HSHFIT_[A-Z]+", text):
        assert option in OPTIONS, f"{where}: CMakeLists.txt has no {option}"


def stand_ins(copied):
    """The modules that the recipe imports, of which `copy` notes what it is asked for."""
    names = {"conan": ["ConanFile"], "conan.tools": [], "conan.tools.build": ["check_min_cppstd"],
             "conan.tools.cmake": ["CMake", "CMakeDeps", "CMakeToolchain", "cmake_layout"],
             "conan.tools.files": []}
    for name, members in names.items():
        module = types.ModuleType(name)
        for member in members:
            setattr(module, member, type(member, (), {}))
        sys.modules[name] = module
    sys.modules["conan.tools.files"].copy = (
        lambda recipe, pattern, source, to: copied.append((pattern, source)))


def check_conan():
    copied = []
    stand_ins(copied)
    path = ROOT / "packaging/conan/conanfile.py"
    space = {"__file__": str(path), "__name__": "conanfile"}
    exec(compile(path.read_text(), str(path), "exec"), space)
    recipe = space["Hshfit"]()
    recipe.set_version()
    assert recipe.version == VERSION
    with tempfile.TemporaryDirectory() as folder:
        recipe.export_sources_folder = folder
        recipe.export_sources()
    for pattern, source in copied:
        assert next(Path(source).glob(pattern), None), f"conanfile.py: {pattern} names no file"
    check_options(path.read_text(), "conanfile.py")
    found = {}
    for part in recipe.__class__.options["parts"]:
        asked = []
        recipe.options = types.SimpleNamespace(system=False, parts=part)
        recipe.requires = asked.append
        recipe.requirements()
        for one in asked:
            assert re.fullmatch(r"[a-z0-9_+-]+/[\w.]+", one), f"conanfile.py: {one}"
        found[part] = {VCPKG_NAMES.get(name, name) for name, _ in (one.split("/") for one in asked)}
    return found


def main():
    vcpkg, conan = check_vcpkg(), check_conan()
    assert conan["math"] == vcpkg["math"], conan["math"] ^ vcpkg["math"]
    both = vcpkg["math"] | vcpkg["files"]
    assert conan["files"] == both, conan["files"] ^ both


main()
