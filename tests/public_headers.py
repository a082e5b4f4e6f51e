#!/usr/bin/env python3
"""public_headers.py [--update | --list]: the headers that `cmake --install` installs.

Public are the headers of lib/hshfit outside internal/ without the PRIVATE_HEADERS of their room,
those of the front door in lib/CMakeLists.txt, and the list `public` in brdfs/CMakeLists.txt.
Prints each breach and ends with 1 if there is one:
  - a public header includes public ones, the standard library, POSIX and fmt only;
  - the table of docs/reference/library.md has every public header, by room;
  - the quick start of that page is examples/quick_start.cpp, of at most 20 lines.
With --update: writes that table into the page. With --list: the headers as programs include them.
"""
import re
import sys

from room_graph import LIB, TOP, room_order

PAGE = TOP / "docs" / "reference" / "library.md"
GENERATED = "hshfit/version.h"


def library_headers():
    """Room to its public headers, as they are included; '' is the front door."""
    order = room_order()
    private = {}
    for room in order:
        text = (LIB / room / "CMakeLists.txt").read_text()
        found = re.search(r"PRIVATE_HEADERS\s+((?:[\w./-]+\s*)+)", text)
        private[room] = found.group(1).split() if found else []
    rooms = {room: [] for room in ["", *order]}
    for path in sorted(LIB.rglob("*.h")):
        folder = str(path.parent.relative_to(LIB))
        if folder in private and path.name not in private[folder]:
            rooms[folder].append(f"hshfit/{folder}/{path.name}")
    text = (TOP / "lib" / "CMakeLists.txt").read_text()
    door = re.search(r"install\(FILES ([^)]*)DESTINATION", text).group(1)
    rooms[""] = re.findall(r"(?:^|[ /])(hshfit/\w+\.h)\b", door)
    return rooms


def brdf_headers():
    text = (TOP / "brdfs" / "CMakeLists.txt").read_text()
    names = re.search(r"^set\(public\s+([^)]*)\)", text, re.MULTILINE).group(1).split()
    return [f"brdfs/{name}" for name in names]


def source(header):
    return TOP / header if header.startswith("brdfs/") else TOP / "lib" / header


def breaches(public):
    known = set(public)
    for header in public:
        if header == GENERATED:
            continue
        for number, line in enumerate(source(header).read_text().split("\n"), 1):
            found = re.match(r'\s*#include [<"]([^>"]+)[>"]', line)
            if not found or found.group(1) in known:
                continue
            if not re.fullmatch(r"[a-z_]+|sys/[a-z]+\.h|fmt/\w+\.h", found.group(1)):
                yield f"{source(header).relative_to(TOP)}:{number}: public, but includes {found[1]}"


def table(rooms, brdfs):
    lines = ["| room | headers |", "|---|---|"]
    for room, headers in rooms.items():
        where = f"hshfit/{room}".rstrip("/")
        names = ", ".join(f"`{header.rsplit('/', 1)[1]}`" for header in sorted(headers))
        lines.append(f"| `{where}` | {names} |")
    folders = {}
    for header in brdfs:
        folders.setdefault(header.rsplit("/", 1)[0], []).append(header.rsplit("/", 1)[1])
    for folder, names in folders.items():
        lines.append(f"| `{folder}` | {', '.join(f'`{name}`' for name in sorted(names))} |")
    return "\n".join(lines)


def main():
    rooms, brdfs = library_headers(), brdf_headers()
    public = [header for headers in rooms.values() for header in headers] + brdfs
    if sys.argv[1:] == ["--update"]:
        start = r"\| room \| headers \|\n(\|.*\n)+"
        PAGE.write_text(re.sub(start, lambda _: table(rooms, brdfs) + "\n", PAGE.read_text()))
        return 0
    if sys.argv[1:] == ["--list"]:
        print("\n".join(public))
        return 0
    found = list(breaches(public))
    if table(rooms, brdfs) not in PAGE.read_text():
        found.append(f"{PAGE.relative_to(TOP)}: the table of headers is not that of "
                     "tests/public_headers.py --update")
    quick_start = (TOP / "examples" / "quick_start.cpp").read_text()
    if f"```cpp\n{quick_start}```" not in PAGE.read_text() or quick_start.count("\n") > 20:
        found.append(f"{PAGE.relative_to(TOP)}: the quick start is examples/quick_start.cpp, "
                     "of at most 20 lines")
    print("\n".join(found), end="\n" if found else "")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
