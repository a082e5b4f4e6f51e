#!/usr/bin/env python3
"""skipped_tests.py JUNIT: one line on the tests of a run that ctest skipped, counted by reason.

Reads what `ctest --output-junit` writes. GoogleTest prints the reason below "Skipped"; checks that
are scripts print "skipped: REASON"; a check that leaves out one of several tools prints
"NAME not checked: REASON".
"""
import re
import sys
from collections import Counter
from xml.etree import ElementTree

GTEST = re.compile(r": Skipped\n(.*)")
SCRIPT = re.compile(r"^skipped: (.*)", re.MULTILINE)
PART = re.compile(r"^(.*) not checked: (.*)", re.MULTILINE)


def reasons(path):
    """The reasons of the skipped tests and those of parts of tests, one entry each."""
    whole, parts = [], []
    for case in ElementTree.parse(path).getroot().iter("testcase"):
        text = case.findtext("system-out") or ""
        if case.find("skipped") is not None:
            found = GTEST.search(text) or SCRIPT.search(text)
            whole.append(found.group(1).strip() if found else "no reason given")
        else:
            parts += [reason for _, reason in PART.findall(text)]
    return whole, parts


def counted(entries):
    """'3 x no node; 1 x no gnuplot', the most frequent first."""
    return "; ".join(f"{count} x {reason}" for reason, count in Counter(entries).most_common())


def main():
    whole, parts = reasons(sys.argv[1])
    line = f"skipped: {len(whole)} tests"
    if whole:
        line += f": {counted(whole)}"
    if parts:
        line += f"; left out within tests: {counted(parts)}"
    print(line)


if __name__ == "__main__":
    main()
