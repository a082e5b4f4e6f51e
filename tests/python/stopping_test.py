"""In processes of their own: threads call functions of Python, and SIGINT ends long work."""
import ast
import os
import signal
import subprocess
import sys
import time
import unittest
from pathlib import Path

import hshfit
import program

# Breaks a process that hangs. Every piece of work that is stopped here would take longer.
MOST_SECONDS = 30

FUNCTION = """
import hshfit
f = hshfit.function(lambda wi, wo: [0.1] * len(wi), isotropic=True, mirror_symmetric=True)
"""
# The first use of a function in a process.
USES = {
    "project": "hshfit.project(f, order=3, outgoing=16)",
    "project_all": "hshfit.project_all(f, order=3, outgoing=16)",
    "curves": "hshfit.curves(f, max_order=3)",
    "compare": "hshfit.compare(f, 'lambert')",
    "picture_error": "hshfit.picture_error(f, 'lambert')",
    "fit": "hshfit.fit(f, 'lambert', starts=1)",
    "rank_models": "hshfit.rank_models(f, ['lambert'], starts=1)",
    "Brdf.__call__": "f([[0, 0, 1]] * 20000, [0, 0, 1])",
    "Brdf.albedo": "f.albedo([[0, 0, 1]] * 16)",
    "Brdf.sphere": "f.sphere(32)",
    "Brdf.write": "f.write('f.alta')",
}

# Long work: preparation and call. A sum of many models takes long to evaluate.
SUM = "' + '.join(['ggx:alpha=0.3'] * 250)"
WORK = {
    "pairs": (f"import numpy\nf = hshfit.open({SUM})\n"
              "wo = hshfit.direction(numpy.linspace(0, 80, 3_000_000))", "f([0, 0, 1], wo)"),
    "pairs of a function": ("import time\n"
                            "f = hshfit.function(lambda wi, wo: time.sleep(0.01) or 1)\n"
                            "wi = hshfit.direction([0.01 * k % 80 for k in range(100_000)])",
                            "f(wi, wi)"),
    "irradiance": ("", "hshfit.irradiance('sky:type=12,elevation=40', normals=1_000_000)"),
    "light": ("", "hshfit.light('sky:type=12,elevation=40', order=1000, tolerance=1e-13)"),
    "rank_models": ("", "hshfit.rank_models('ggx:alpha=0.3', ['ggx+lambert'], starts=10_000)"),
    "sample": ("", "hshfit.sample(' + '.join(['ggx:alpha=0.3'] * 30), [0, 0, 1], "
                   "count=10_000_000)"),
    "predict": ("fit = hshfit.fit('ggx:alpha=0.3', 'ggx', starts=1)\n"
                "wi = hshfit.direction([0.01 * k % 80 for k in range(3_000_000)])",
                "fit.predict(wi, [0, 0, 1])"),
    "rotate": ("c = hshfit.project('lambert', order=140, outgoing=64).coefficients",
               "c.rotate(hshfit.Rotation(up=(30, 0)))"),
    "project": ("", "hshfit.project('ward:ax=0.0002,ay=0.3', outgoing=(70, 0), order=1000, "
                    "max_evaluations=1e12)"),
}


def started(code):
    return subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True)


class Processes(program.InFolder):
    def ended(self, process):
        """Exit code and errors of a process, which may not hang."""
        try:
            _, errors = process.communicate(timeout=MOST_SECONDS)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
            self.fail(f"still at work after {MOST_SECONDS} s")
        return process.returncode, errors

    def test_functions_are_called_from_threads_before_numpy_is_imported(self):
        stubs = ast.parse(Path(hshfit.__file__).with_name("__init__.pyi").read_text())
        takers = {node.name for node in stubs.body if isinstance(node, ast.FunctionDef)
                  and "BrdfLike" in ast.unparse(node.args)}
        self.assertEqual(takers, {name for name in USES if "." not in name})
        for name, use in USES.items():
            with self.subTest(function=name):
                self.assertEqual(self.ended(started(FUNCTION + use)), (0, ""))

    def test_interrupt_ends_long_work(self):
        for name, (before, call) in WORK.items():
            with self.subTest(work=name):
                process = started(f"import hshfit\n{before}\nprint('go', flush=True)\n{call}")
                self.assertEqual(process.stdout.readline(), "go\n")
                time.sleep(1)
                self.assertIsNone(process.poll(), "over before it was stopped")
                process.send_signal(signal.SIGINT)
                code, errors = self.ended(process)
                self.assertEqual(errors.strip().split("\n")[-1], "KeyboardInterrupt")
                self.assertEqual(code, -signal.SIGINT)
        self.assertEqual(os.listdir("."), [])


if __name__ == "__main__":
    program.main()
