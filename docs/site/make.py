#!/usr/bin/env python3
"""make.py PROGRAM OUT: the documentation as a site in OUT/html.

Collects into OUT/pages what docs/site/index.md lists: the pages of docs/, CONTRIBUTING.md and
CHANGELOG.md, pages that the program writes (program_reference.py) and pages of the public headers
(cpp_reference.py). Sphinx makes a site of them; a warning of Sphinx, such as a link to an anchor
that does not exist or a page that no index lists, is an error. So is a link to a file that
does not exist. Ends with 77 where Sphinx or its parts are not installed.
"""
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
TOP = HERE.parents[1]
sys.path.insert(0, str(HERE))
import cpp_reference  # noqa: E402
import program_reference  # noqa: E402

# Pages outside docs/, by their place in the site.
OUTSIDE = {"CONTRIBUTING.md": "contributing.md", "CHANGELOG.md": "changelog.md"}
# Languages of files that are shown, by extension.
KINDS = {".cpp": "cpp", ".json": "json", ".py": "python", ".sh": "sh"}
LINK = re.compile(r"(!?\[(?:[^][]|\[[^][]*\])*\]\()([^)\s]+)(\))")


def place_of(path, shown):
    """The place in the site of a file of the project that a page links to. A file that is no page
    is shown by one of its own, which `shown` collects."""
    name = path.relative_to(TOP).as_posix()
    if name in OUTSIDE:
        return OUTSIDE[name]
    if name == "docs/schemas":
        return "reference/schemas/index.md"
    if name.startswith("docs/schemas/"):
        return f"reference/schemas/{path.name.removesuffix('.schema.json')}.md"
    if name.startswith("docs/") and path.suffix in (".md", ".png", ".svg"):
        return name.removeprefix("docs/")
    shown.add(path)
    return f"sources/{name}.md"


def relinked(page, at, shown):
    """The text of a page whose place in the site is `at`, with links to places in the site."""
    breaches, text, fence = [], [], None
    for number, line in enumerate(page.read_text(encoding="utf-8").split("\n"), 1):
        if mark := re.match(r"\s*(```+)", line):
            fence = None if fence == mark[1] else fence or mark[1]
        if fence:
            text.append(line)
            continue

        def to_site(found):
            path, _, anchor = found[2].partition("#")
            if re.match(r"[a-z]+:", path) or not path:
                return found[0]
            target = (page.parent / path).resolve()
            if not target.exists():
                breaches.append(f"{page.relative_to(TOP)}:{number}: no file {path}")
                return found[0]
            place = os.path.relpath(place_of(target, shown), Path(at).parent)
            return found[1] + place + ("#" + anchor if anchor else "") + found[3]
        text.append(LINK.sub(to_site, line))
    return "\n".join(text), breaches


def write_source(path, pages):
    """A page that shows a file, or lists a folder."""
    name = path.relative_to(TOP).as_posix()
    page = pages / "sources" / f"{name}.md"
    page.parent.mkdir(parents=True, exist_ok=True)
    lines = ["---", "orphan: true", "---", f"# {name}", ""]
    files = [path] if path.is_file() else sorted(each for each in path.rglob("*") if each.is_file())
    for each in files:
        kind = KINDS.get(each.suffix, "text")
        if len(files) > 1:
            lines += [f"## {each.relative_to(path)}", ""]
        if each.suffix == ".png":
            shutil.copyfile(each, page.parent / each.name)
            lines += [f"![{each.name}]({each.name})", ""]
            continue
        text = each.read_text(encoding="utf-8")
        lines += [f"````{kind}", text.rstrip(), "````", ""]
    page.write_text("\n".join(lines), encoding="utf-8")


def collect(program, pages):
    """Writes all pages; returns the breaches."""
    breaches, shown = [], set()
    sources = {page: page.relative_to(TOP / "docs").as_posix()
               for page in (TOP / "docs").rglob("*.md") if HERE not in page.parents}
    sources |= {TOP / name: place for name, place in OUTSIDE.items()}
    sources[HERE / "index.md"] = "index.md"
    for page, place in sources.items():
        text, found = relinked(page, place, shown)
        breaches += found
        target = pages / place
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text, encoding="utf-8")
    # The front page of the project is no page of the site; its links have to hold too.
    breaches += relinked(TOP / "README.md", "readme.md", set())[1]
    for path in shown:
        write_source(path, pages)
    for picture in (TOP / "docs").rglob("*"):
        if picture.suffix in (".png", ".svg"):
            place = pages / picture.relative_to(TOP / "docs")
            place.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(picture, place)
    reference = pages / "reference"
    program_reference.write_commands(program, reference)
    program_reference.write_catalogs(program, reference)
    program_reference.write_schemas(reference)
    cpp_reference.write(reference / "cpp")
    return breaches


def missing_tool():
    """The Debian package that this needs and that is missing; Sphinx runs in its own Python."""
    sphinx = shutil.which("sphinx-build")
    if not sphinx:
        return "python3-sphinx"
    python = Path(sphinx).read_text(encoding="utf-8").split("\n")[0].removeprefix("#!").split()
    for module, package in (("myst_parser", "python3-myst-parser"), ("furo", "furo")):
        if subprocess.run([*python, "-c", f"import {module}"], capture_output=True,
                          check=False).returncode:
            return package
    return None


def main():
    if len(sys.argv) != 3:
        sys.exit("usage: make.py PROGRAM OUT")
    if missing := missing_tool():
        print(f"skipped: {missing} is not installed")
        return 77
    program, out = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
    pages, html = out / "pages", out / "html"
    for folder in (pages, html):
        shutil.rmtree(folder, ignore_errors=True)
    breaches = collect(program, pages)
    if breaches:
        sys.exit("\n".join(breaches))
    version = subprocess.run([program, "--version"], capture_output=True, text=True, check=True)
    env = os.environ | {"HSHFIT_VERSION": version.stdout.split()[-1]}
    return subprocess.run(
        ["sphinx-build", "-b", "html", "-c", HERE, "-d", out / "doctrees",
         "-n", "-W", "--keep-going", "-q", "-j", "auto", pages, html], env=env, check=False,
        ).returncode


if __name__ == "__main__":
    sys.exit(main())
