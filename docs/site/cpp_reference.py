#!/usr/bin/env python3
"""cpp_reference.py [--undocumented]: the public names of the library, from the docstrings.

Reads the headers of tests/public_headers.py --list: every declaration at the level of a namespace
with the `///` comment above it. A comment also covers the declarations that follow without an
empty line; a struct is also documented by the comments of its members. Members that are private,
bodies of functions and `using` of names from other namespaces are left out.

--undocumented prints each name without documentation as file:line and ends with 1 if there is one.
"""
import re
import sys
from dataclasses import dataclass, field
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP / "tests"))
import public_headers  # noqa: E402

GENERATED = public_headers.GENERATED


@dataclass
class Declaration:
    line: int
    name: str
    code: str


@dataclass
class Entry:
    """A comment and the declarations that it documents."""
    comment: list[str] = field(default_factory=list)
    declarations: list[Declaration] = field(default_factory=list)

    def documented(self):
        return bool(self.comment) or all("///" in one.code for one in self.declarations)


@dataclass
class Header:
    path: str
    introduction: list[str]
    entries: list[Entry]


def without_comment(line):
    """The line with texts emptied and without a comment, for counting brackets."""
    line = re.sub(r'"(\\.|[^"\\])*"', '""', line)
    line = re.sub(r"'(\\.|[^'\\])'", "''", line)
    return line.split("//")[0]


def name_of(code):
    """The name that a declaration introduces; '' for one that introduces none of its own."""
    flat = " ".join(without_comment(line) for line in code.split("\n"))
    flat = re.sub(r"\[\[\w+\]\]", "", flat)
    if re.match(r"\s*template\s*<>", flat):
        return ""
    while found := re.match(r"\s*template\s*<", flat):
        depth, at = 1, found.end()
        while depth:
            depth += {"<": 1, ">": -1}.get(flat[at], 0)
            at += 1
        flat = flat[at:]
    flat = re.sub(r"^\s*requires\s*(\([^)]*\)|[\w:<>]+)", "", flat).strip()
    if found := re.match(r"(?:struct|class|union|enum(?: class)?)\s+([\w:]+(?:<[^{;]*?>)?)\s*(.?)",
                         flat):
        return "" if found[2] == ";" else found[1]
    if found := re.match(r"using\s+(\w+)\s*=", flat):
        return found[1]
    if flat.startswith(("using ", "static_assert", "namespace ")):
        return ""
    if found := re.search(r"(operator\s*[^\s(]+|operator\(\)|[\w:~]+)\s*\(", flat):
        head = flat[:found.start()]
        if "=" not in head and "{" not in head:
            return re.sub(r"\s+", "", found[1])
    found = re.search(r"(\w+)\s*(?:\[[^]]*\]\s*)*(?:[={;,]|$)", flat)
    return found[1] if found else ""


def shown(code):
    """A declaration as the page shows it: no bodies of functions, no private members."""
    first = without_comment(code.split("\n")[0])
    lines = code.split("\n")
    if re.search(r"^\s*(?:template\s*<.*>\s*)?(struct|class|union)\b", " ".join(lines[:3])):
        kept = []
        for at, line in enumerate(lines):
            if re.fullmatch(r"\s*private:", line):
                return "\n".join([*kept, lines[-1]]).replace("\n\n}", "\n}")
            kept.append(line)
        return code
    if re.match(r"\s*enum\b", first):
        return code
    flat = "\n".join(lines)
    found = re.search(r"\)\s*(const\s*)?(noexcept\s*)?(->\s*[\w:<>*& ]+)?\{", flat)
    return flat[:found.end() - 1].rstrip() + ";" if found else code


def read(path, text):
    header = Header(path, [], [])
    comment, code, start, depth = [], [], 0, 0
    follows = False
    seen_include = False
    for number, line in enumerate(text.split("\n"), 1):
        bare = line.strip()
        if not code:
            if bare.startswith("///"):
                comment.append(bare[3:].removeprefix(" "))
                continue
            if bare.startswith("//"):
                if not seen_include and not header.entries:
                    header.introduction.append(bare[2:].removeprefix(" "))
                continue
            seen_include = seen_include or bare.startswith("#include")
            if not bare or bare.startswith("#") or re.match(r"(inline )?namespace\b.*\{$", bare) \
                    or re.match(r"\}\s*(//.*)?$", bare):
                if not bare:
                    follows, comment = False, []
                continue
            start = number
        code.append(line)
        counted = without_comment(line)
        depth += sum(counted.count(c) for c in "({") - sum(counted.count(c) for c in ")}")
        if depth or not counted.rstrip().endswith((";", "}")):
            continue
        whole = "\n".join(code)
        name = name_of(whole)
        if name:
            one = Declaration(start, name, shown(whole))
            if follows and not comment and header.entries:
                header.entries[-1].declarations.append(one)
            else:
                header.entries.append(Entry(comment, [one]))
        follows, comment, code = bool(name), [], []
    return header


def headers():
    """Room to its public headers, read; '' is the front door, 'brdfs…' what opens BRDFs."""
    rooms, brdfs = public_headers.library_headers(), public_headers.brdf_headers()
    for path in brdfs:
        rooms.setdefault(path.rsplit("/", 1)[0], []).append(path)
    return {room: [read(path, public_headers.source(path).read_text(encoding="utf-8"))
                   for path in sorted(paths) if path != GENERATED]
            for room, paths in rooms.items()}


def escaped(text):
    """Text of a comment as Markdown; code in back-quotes stays."""
    parts = text.split("`")
    for at in range(0, len(parts), 2) if len(parts) % 2 else range(len(parts)):
        parts[at] = re.sub(r"([\\*_<>\[\]#|{}~$])", r"\\\1", parts[at])
    return "`".join(parts) if len(parts) % 2 else r"\`".join(parts)


def prose(comment):
    """A comment as Markdown. Lines that are indented, formulas and tables, stay as they are."""
    out, code = [], False
    listed = False
    for line in comment:
        listed = line.startswith("- ") or (listed and line.startswith("  "))
        formula = line.startswith("    ") or (line.startswith("  ") and not listed)
        if formula != code and (formula or line):
            out.append("```text" if formula else "```")
            if not formula:
                out.append("")
            code = formula
        out.append(line if code else escaped(line))
    if code:
        out.append("```")
    return "\n".join(out)


def page(room, content):
    where = room if room.startswith("brdfs") else f"hshfit/{room}".rstrip("/")
    lines = [f"# {where}", ""]
    for header in content:
        lines += [f"## {header.path.rsplit('/', 1)[1]}", "",
                  f"```cpp\n#include <{header.path}>\n```", ""]
        if header.introduction:
            lines += [prose(header.introduction), ""]
        for entry in header.entries:
            names = list(dict.fromkeys(one.name for one in entry.declarations))
            lines += ["### " + ", ".join(escaped(name) for name in names), ""]
            code = "\n".join(one.code for one in entry.declarations)
            lines += [f"```cpp\n{code}\n```", "", prose(entry.comment), ""]
    return "\n".join(lines)


def write(folder):
    """Writes a page for each room into the folder, and their index."""
    folder.mkdir(parents=True)
    rows, pages = [], []
    count = 0
    for room, content in headers().items():
        if not content:
            continue
        name = room.replace("/", "_") or "front_door"
        (folder / f"{name}.md").write_text(page(room, content), encoding="utf-8")
        pages.append(name)
        names = sum(len(entry.declarations) for header in content for entry in header.entries)
        count += names
        where = room if room.startswith("brdfs") else f"hshfit/{room}".rstrip("/")
        rows.append(f"| [{where}]({name}.md) | {len(content)} | {names} |")
    lines = ["# C++ names", "",
             f"The {count} public names of the library, with the comments of their headers. "
             "[hshfit as a library](../library.md) has the ways to link and the promise on "
             "stability.", "", "| folder | headers | names |", "|---|---|---|", *rows, "",
             "```{toctree}", ":hidden:", "", *pages, "```", ""]
    (folder / "index.md").write_text("\n".join(lines), encoding="utf-8")


def main():
    found = 0
    for content in headers().values():
        for header in content:
            where = public_headers.source(header.path).relative_to(TOP)
            for entry in header.entries:
                if not entry.documented():
                    for one in entry.declarations:
                        print(f"{where}:{one.line}: {one.name} has no comment")
                        found += 1
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
