#!/usr/bin/env python3
"""room_graph.py [--table]: the rooms of lib/hshfit, brdfs and jobs against the includes of their
files.

The order of add_subdirectory in lib/CMakeLists.txt is the order of the rooms, the lowest first; for
brdfs and jobs it is the list hshfit_brdfs_rooms or hshfit_jobs_rooms of their CMakeLists.txt.
Prints each breach as file:line and ends with 1 if there is one:
  - a room includes only rooms below it, so that no two rooms include each other, and the front
    door none but in hshfit.h;
  - the NEEDS of a room in its CMakeLists.txt are the rooms that it includes;
  - a header under internal/ is included from its own room, from tests and from benchmarks only;
  - the namespace of a file is its folder (lib);
  - files of brdfs or jobs that lie in no room, the front door, are included by no room.
With --table: files, lines and needed rooms of each, as a table in Markdown.
"""
import re
import subprocess
import sys
from pathlib import Path

TOP = Path(__file__).resolve().parent.parent
LIB = TOP / "lib" / "hshfit"


def room_order():
    text = (TOP / "lib" / "CMakeLists.txt").read_text()
    return re.findall(r"^add_subdirectory\(hshfit/([\w/]+)\)", text, re.MULTILINE)


def tracked(*patterns):
    lines = subprocess.run(["git", "ls-files", *patterns], cwd=TOP, check=True,
                           capture_output=True, text=True).stdout.split("\n")
    return [TOP / line for line in lines if line and (TOP / line).exists()]


class Rooms:
    def __init__(self):
        self.order = room_order()
        self.rank = {room: k for k, room in enumerate(self.order)}
        self.needs = {room: set() for room in self.order}
        self.breaches = []

    def of(self, path):
        """The room of a path below lib/hshfit: its deepest folder that is a room; '' if none."""
        folder = Path(path).parent
        while str(folder) != "." and str(folder) not in self.rank:
            folder = folder.parent
        return "" if str(folder) == "." else str(folder)

    def breach(self, path, line, text):
        self.breaches.append(f"{path.relative_to(TOP)}:{line}: {text}")

    def check_include(self, path, number, target, home):
        room = self.of(target)
        if "/internal/" in target and room != home:
            if path.parts[len(TOP.parts)] not in ("tests", "bench"):
                self.breach(path, number, f"{target} is internal to {room}")
        if home is None or not room or room == home:
            return
        if not home and path.name == "hshfit.h":
            return
        if not home:
            self.breach(path, number, f"the front door includes {target}")
            return
        self.needs[home].add(room)
        if self.rank[room] > self.rank[home]:
            self.breach(path, number, f"{home} includes {target}, of a room above it")

    def check_namespace(self, path, home):
        text = path.read_text()
        found = re.search(r"^namespace (hshfit[\w:]*(?:::inline \w+)*)", text, re.MULTILINE)
        spaces = [re.sub(r"inline ", "", s).split("::HWY_NAMESPACE")[0] for s in
                  re.findall(r"^namespace (hshfit(?:::(?:inline )?\w+)*) \{", text, re.MULTILINE)]
        expected = "::".join(["hshfit", *home.split("/")] if home else ["hshfit"])
        if found and not any(s == expected or s.startswith(expected + "::") for s in spaces):
            line = text[: found.start()].count("\n") + 1
            self.breach(path, line, f"the namespace of this folder is {expected}")

    def check_needs(self, room):
        path = LIB / room / "CMakeLists.txt"
        text = path.read_text()
        stated = re.search(r"NEEDS ([\w\s]*?)(?:LINKS|PRIVATE_HEADERS|\))", text)
        stated = set(stated.group(1).split()) if stated else set()
        for name in sorted(stated ^ {need.replace("/", "_") for need in self.needs[room]}):
            verb = "includes nothing of" if name in stated else "does not list"
            self.breach(path, 1, f"NEEDS: {room} {verb} {name}")

    def check(self):
        for path in tracked("*.h", "*.cpp"):
            inside = LIB in path.parents
            home = self.of(path.relative_to(LIB)) if inside else None
            for number, line in enumerate(path.read_text().split("\n"), 1):
                found = re.match(r'\s*#include [<"]hshfit/([^>"]+)[>"]', line)
                if found:
                    self.check_include(path, number, found.group(1), home)
            if inside:
                self.check_namespace(path, home)
        for room in self.order:
            self.check_needs(room)


class HouseRooms:
    """The rooms of brdfs or jobs."""

    def __init__(self, house):
        self.house = house
        text = (TOP / house / "CMakeLists.txt").read_text()
        stated = re.search(rf"set\(hshfit_{house}_rooms ([\w\s]+)\)", text)
        self.order = stated.group(1).split()
        self.needs = {room: set() for room in self.order}
        self.breaches = []

    def of(self, path):
        """The room of a path below the house; '' at its front door."""
        first = Path(path).parts[0]
        return first if first in self.order else ""

    def check(self):
        for path in tracked(f"{self.house}/*.h", f"{self.house}/*.cpp"):
            home = self.of(path.relative_to(TOP / self.house))
            place = path.relative_to(TOP / self.house)
            if not home and len(place.parts) > 1:
                self.breaches.append(f"{path.relative_to(TOP)}:1: its folder is no room")
            for number, line in enumerate(path.read_text().split("\n"), 1):
                found = re.match(rf"\s*#include <{self.house}/([^>]+)>", line)
                if not found or not home:
                    continue
                room = self.of(found.group(1))
                if room == home:
                    continue
                self.needs[home].add(room)
                if not room or self.order.index(room) > self.order.index(home):
                    above = room or "the front door"
                    self.breaches.append(f"{path.relative_to(TOP)}:{number}: {home} includes "
                                         f"{found.group(1)}, of {above} above it")


    def table(self):
        sizes = {room: [0, 0] for room in self.order}
        for path in tracked(f"{self.house}/*.h", f"{self.house}/*.cpp"):
            room = self.of(path.relative_to(TOP / self.house))
            if room:
                sizes[room][0] += 1
                sizes[room][1] += len(path.read_text().split("\n")) - 1
        print(f"\n| room of `{self.house}/` | files | lines | includes |\n|---|---|---|---|")
        for room in self.order:
            below = ", ".join(sorted(self.needs[room], key=self.order.index)) or "none"
            print(f"| {room} | {sizes[room][0]} | {sizes[room][1]} | {below} |")


def table(rooms):
    sizes = {room: [0, 0] for room in rooms.order}
    for path in tracked("lib/hshfit"):
        room = rooms.of(path.relative_to(LIB))
        if room:
            sizes[room][0] += 1
            sizes[room][1] += len(path.read_text().split("\n")) - 1
    whole = sum(lines for _, lines in sizes.values())
    print("| room | files | lines | share | includes |\n|---|---|---|---|---|")
    for room in rooms.order:
        files, lines = sizes[room]
        below = ", ".join(sorted(rooms.needs[room], key=rooms.rank.get)) or "none"
        print(f"| `{room}` | {files} | {lines} | {100 * lines / whole:.1f} % | {below} |")


def main():
    rooms = Rooms()
    rooms.check()
    houses = [HouseRooms(house) for house in ("brdfs", "jobs")]
    for house in houses:
        house.check()
    if sys.argv[1:] == ["--table"]:
        table(rooms)
        for house in houses:
            house.table()
    breaches = rooms.breaches + [breach for house in houses for breach in house.breaches]
    for breach in breaches:
        print(breach, file=sys.stderr if sys.argv[1:] else sys.stdout)
    return 1 if breaches else 0


if __name__ == "__main__":
    sys.exit(main())
