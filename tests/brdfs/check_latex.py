#!/usr/bin/env python3
"""check_latex.py FILE.tex: whether TeX's rules hold for the LaTeX of a table, by a small reader.

Groups and environments close in their order, '$' pairs up, a base has one superscript and one
subscript, '^', '_' and symbols stand in mathematics alone, text has no special characters, a row
of a tabular has its columns, and every command is one that LaTeX has without packages. Prints each
breach and ends with 1 if there is one. With pdflatex on the PATH the file is compiled as well.
"""
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

TEXT = {"begin", "end", "par", "smallskip", "medskip", "textsuperscript", "textbackslash",
        "textasciitilde", "textasciicircum", "ensuremath", "char", "toprule", "midrule",
        "bottomrule", "hline", "providecommand", "\\", ",", "%", "$", "&", "#", "_", "{", "}"}
MATHS = {"times", "pm", "infty", "chi", "nu", "mu", "circ", "mathrm"}
LAST = 0x17F  # of the letters that LaTeX knows without a package
TOKEN = re.compile(r"\\([A-Za-z]+|.)|(%[^\n]*\n?)|([{}$^_&#~])|(.)", re.DOTALL)


class Reader:
    def __init__(self, text):
        self.text = text
        self.found = []
        self.groups = []
        self.maths = False
        self.scripts = set()  # of the base in mathematics
        self.pending = False  # a script waits for its argument
        self.columns = self.cells = 0

    def fail(self, at, what):
        self.found.append(f"line {self.text.count(chr(10), 0, at) + 1}: {what}")

    def base(self):
        """Something that a script may stand behind."""
        if self.pending:
            self.pending = False
        elif not self.groups or self.groups[-1] != "script":
            self.scripts = set()

    def script(self, at, sign):
        if not self.maths:
            self.fail(at, f"'{sign}' outside of mathematics")
        elif sign in self.scripts:
            self.fail(at, f"a second '{sign}' behind one base")
        self.scripts.add(sign)
        self.pending = True

    def command(self, at, name):
        if name in MATHS and not self.maths:
            self.fail(at, f"\\{name} outside of mathematics")
        elif name not in MATHS and name not in TEXT:
            self.fail(at, f"\\{name} is no command without a package")
        if name == "\\" and self.columns:
            if self.cells + 1 != self.columns:
                self.fail(at, f"{self.cells + 1} cells for {self.columns} columns")
            self.cells = 0
        if self.maths:
            self.base()

    def environment(self, at):
        mark = re.match(r"\\(begin|end)\{(\w+)\}(?:\{([lrc]*)\})?", self.text[at:])
        if mark[1] == "begin":
            self.groups.append(mark[2])
            self.columns, self.cells = len(mark[3] or ""), 0
        elif not self.groups or self.groups.pop() != mark[2]:
            self.fail(at, f"\\end{{{mark[2]}}} closes another group")
        else:
            self.columns = 0
        return at + mark.end()

    def sign(self, at, char):
        if char == "{":
            self.groups.append("script" if self.pending else "group")
            self.pending = False
        elif char == "}":
            if not self.groups or self.groups[-1] not in ("group", "script"):
                self.fail(at, "'}' without its '{'")
            elif self.groups.pop() == "group":
                self.base()
        elif char == "$":
            self.maths = not self.maths
            self.scripts = set()
        elif char in "^_":
            self.script(at, char)
        elif char == "&" and self.columns:
            self.cells += 1
        else:
            self.fail(at, f"a bare '{char}'")

    def read(self):
        at = 0
        while at < len(self.text):
            mark = TOKEN.match(self.text, at)
            name, comment, sign, other = mark.groups()
            if name in ("begin", "end"):
                at = self.environment(at)
                continue
            if name is not None:
                self.command(at, name)
            elif sign:
                self.sign(at, sign)
            elif other and other in "<>|\"" and not self.maths:
                self.fail(at, f"a bare '{other}'")
            elif other and ord(other) > LAST:
                self.fail(at, f"'{other}' is in no font of LaTeX")
            elif other and not other.isspace() and self.maths:
                self.base()
            at = mark.end()
        if self.groups or self.maths:
            self.fail(at, f"open at the end: {self.groups or '$'}")
        return self.found


def compiled(path):
    """The complaints of pdflatex; none where it is not installed."""
    if not shutil.which("pdflatex"):
        return []
    with tempfile.TemporaryDirectory() as folder:
        shutil.copy(path, Path(folder) / "table.tex")
        main = Path(folder) / "main.tex"
        main.write_text("\\documentclass{article}\n\\begin{document}\n\\input{table}\n"
                        "\\end{document}\n", encoding="utf-8")
        done = subprocess.run(["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "main"],
                              cwd=folder, capture_output=True, text=True, errors="replace",
                              check=False)
        lines = [line for line in done.stdout.splitlines() if line.startswith("!")]
        return lines if done.returncode else []


def main():
    path = sys.argv[1]
    found = Reader(Path(path).read_text(encoding="utf-8")).read() + compiled(path)
    print("\n".join(found), end="\n" if found else "")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
