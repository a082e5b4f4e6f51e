"""Failures are exceptions by kind, with the program's messages; long work can be stopped."""
import os
import re
import signal
import threading
import time
import unittest
import warnings

import numpy as np

import hshfit
import program
from hshfit import _arguments

UP = [0.0, 0.0, 1.0]


class Kinds(program.InFolder):
    def test_kinds_have_the_exit_codes_of_the_program(self):
        codes = {hshfit.UsageError: 2, hshfit.InputError: 3, hshfit.NumericError: 4,
                 hshfit.OutputError: 5}
        for kind, code in codes.items():
            self.assertTrue(issubclass(kind, hshfit.Error))
            self.assertEqual(kind.exit_code, code)

    def check(self, call, kind, *words):
        """The exception has the kind and the message of the program for the same."""
        with self.assertRaises(kind) as caught:
            call()
        code, message = self.refusal(*words)
        self.assertEqual(kind.exit_code, code)
        # Options have the names of arguments.
        named = re.sub(r"--([a-z-]+)", lambda option: option[1].replace("-", "_"), message)
        self.assertEqual(str(caught.exception), named)

    def test_messages_are_those_of_the_program(self):
        with open("broken.json", "w", encoding="ascii") as file:
            file.write('{"format": "hshfit-coefficients", "version": 1}')
        self.check(lambda: hshfit.open("broken.json"), hshfit.InputError, "eval", "broken.json",
                   "--wi", "0,0", "--wo", "0,0")
        self.check(lambda: hshfit.open("absent.binary"), hshfit.InputError, "eval",
                   "absent.binary", "--wi", "0,0", "--wo", "0,0")
        self.check(lambda: hshfit.project("lambert").save("absent/c.json"), hshfit.OutputError,
                   "project", "lambert", "-o", "absent/c.json")
        self.check(lambda: hshfit.project("ggx:alpha=0.01", tolerance=1e-12, order=30,
                                          max_evaluations=1000),
                   hshfit.NumericError, "project", "ggx:alpha=0.01", "--tolerance", "1e-12",
                   "--order", "30", "--max-evaluations", "1000", "-o", "c.json")
        self.assertFalse(os.path.exists("c.json"))

    def test_wrong_arguments_are_named_in_one_line(self):
        brdf = hshfit.open("lambert")
        for call, message in [
                (lambda: hshfit.project("lambert", base="hsh"),
                 r"project\(\) has no argument 'base' \(did you mean 'basis'\?\)"),
                (lambda: hshfit.project("lambert", order="five"),
                 r"project\(\): order is 'five', expected int"),
                (lambda: hshfit.project(), r"project\(\): brdf is missing"),
                (lambda: hshfit.project("lambert", "hsh"),
                 r"project\(\) takes 1 by place \(brdf\); name the others"),
                (lambda: hshfit.direction(1, 2, 3), r"direction\(\) takes 2 by place"),
                (lambda: brdf.albedo(UP, tol=1e-3), r"did you mean 'tolerance'\?"),
                (lambda: hshfit.render("lambert", "x.png", exposuer=1),
                 r"render\(\) has no argument 'exposuer' \(did you mean 'exposure'\?\)"),
                (lambda: hshfit.light("uniform", order=2).rotate(hshfit.Rotation(up=(1, 2)),
                                                                 tabels=3),
                 r"rotate\(\) has no argument 'tabels' \(did you mean 'tables'\?\)"),
                (lambda: hshfit.tradeoff("lambert", zzz=1), r"'zzz'; it takes specs, folder, ")]:
            with self.subTest(message=message), self.assertRaisesRegex(TypeError, message) as got:
                call()
            self.assertNotIn("\n", str(got.exception))

    def test_usage_errors_name_the_right_words(self):
        with self.assertRaisesRegex(hshfit.UsageError, "unknown model 'gxx' .did you mean 'ggx'"):
            hshfit.open("gxx")
        with self.assertRaisesRegex(hshfit.UsageError, "order 4 of basis 'h-basis'"):
            hshfit.project("lambert", basis="h-basis", order=4)
        with self.assertRaisesRegex(hshfit.UsageError, "form='halfway' keeps f: no cosine=True"):
            hshfit.project("lambert", form="halfway", cosine=True)
        with self.assertRaisesRegex(hshfit.UsageError, "least_squares is for files"):
            hshfit.project("lambert", least_squares=True)
        with self.assertRaisesRegex(hshfit.UsageError, "known: bases, models"):
            hshfit.catalog("base")
        with self.assertRaisesRegex(hshfit.UsageError, "1 rotations|0 rotations; give one of"):
            hshfit.Rotation()

    def test_every_argument_of_a_wrong_type_is_named_in_one_line(self):
        class Nothing:
            """No type that any argument takes."""

        found = hshfit.project("lambert", outgoing=4)
        curves = hshfit.curves("lambert", max_order=2, outgoing=4)
        objects = {"Basis": hshfit.Basis("hsh", 2), "Brdf": hshfit.open("lambert"),
                   "Coefficients": found.coefficients, "Projection": found, "Curves": curves,
                   "Curve": curves["hsh"], "Comparison": hshfit.compare("lambert", "lambert"),
                   "Fit": hshfit.fit("lambert", "lambert", starts=1),
                   "Form": hshfit.project("lambert", form="basis"),
                   "Light": hshfit.light("uniform", order=2),
                   "Rotation": hshfit.Rotation(up=(1, 2)),
                   "Library": hshfit.Library.learn(["ggx:alpha=.3", "ggx:alpha=.4"], "a.library"),
                   "Outgoing": hshfit.Outgoing("4")}
        valid = {"brdf": "lambert", "data": "lambert", "a": "lambert", "b": "lambert",
                 "spec": "lambert", "specs": ["lambert"], "model": "lambert", "models": ["lambert"],
                 "path": "out", "file": "out", "output": "out", "folder": "out", "wi": UP, "wo": UP,
                 "directions": UP, "name": "hsh", "basis": "hsh", "order": 2,
                 "rotation": objects["Rotation"], "f": lambda wi, wo: wi[:, 2]}
        tried = set()

        def refused(call, name, argument, needed):
            named = {other: valid.get(other, "lambert") for other in needed} | {argument: Nothing()}
            with self.subTest(function=name, argument=argument):
                with self.assertRaises(TypeError) as got:
                    call(**named)
                message = str(got.exception)
                self.assertNotIn("\n", message)
                self.assertRegex(message, rf"\b{argument}\b")
                self.assertNotRegex(message, "has no argument|is missing|incompatible")
                tried.add((name, argument))

        for name in hshfit.__all__:
            member = getattr(hshfit, name)
            functions = [(name, member, name)]
            if isinstance(member, type):
                of = objects.get(name, member)
                functions = [(method, getattr(of, method), f"{name}.{method}")
                             for method in vars(member) if not method.startswith("_")
                             and callable(getattr(of, method, None))]
                if "__call__" in vars(member):
                    functions.append(("__call__", of, f"{name}.__call__"))
                if "__init__" in vars(member):
                    functions.append(("__init__", member, name))
            for plain, call, shown in functions:
                doc = getattr(member, plain).__doc__ if isinstance(member, type) else call.__doc__
                signature, _ = _arguments._signature(doc, plain)
                signature = [row for row in signature or [] if row[0] != "self"]
                needed = [argument for argument, _, needs in signature if needs]
                for argument, _, _ in signature:
                    refused(call, shown, argument, needed)
        self.assertGreater(len(tried), 400)

    def test_arrays_that_are_no_directions(self):
        f = hshfit.open("lambert")
        with self.assertRaisesRegex(hshfit.UsageError, r"wi: .*shape \(\.\.\., 3\), not \(2\)"):
            f([0, 1], UP)
        for wrong, message in [("up", "wo: no array of numbers"), (3j * np.ones(3), "wo: complex"),
                               (["0", "0", "1"], "wo: no array"), ([0, 0, 1j], "wo: complex"),
                               (np.ma.masked_equal([0., 1, 0], 1), "wo: a masked array"),
                               (np.array(["2020", "2021", "2022"], "datetime64[Y]"), "wo: no")]:
            with self.assertRaisesRegex(TypeError, message):
                f(UP, wrong)
        with self.assertRaisesRegex(hshfit.UsageError, "do not go together"):
            f(np.tile(UP, (2, 1)), np.tile(UP, (3, 1)))
        with self.assertRaisesRegex(hshfit.InputError, r"wi\[1\]: .* has length 2, not 1"):
            f([UP, [0, 0, 2]], UP)
        for number in [np.nan, np.inf, -np.inf]:
            with self.assertRaisesRegex(hshfit.InputError, r"wo\[0\]: .* is not finite"):
                f(UP, [number, 0, 1])
            with self.assertRaisesRegex(hshfit.InputError, r"wi\[1\]: .* is not finite"):
                f([UP, [0, number, 1]], UP)
        with self.assertRaises(TypeError):
            hshfit.project("lambert", ordr=3)

    def test_numbers_out_of_bounds(self):
        with self.assertRaisesRegex(hshfit.UsageError, "tolerance: 2 is not from 1e-13 to 1"):
            hshfit.project("lambert", tolerance=2)
        with self.assertRaisesRegex(hshfit.UsageError, "starts: 0 is not from 1 to 10000"):
            hshfit.fit("lambert", "lambert", starts=0)

    def test_functions_have_to_become_brdfs_first(self):
        with self.assertRaisesRegex(hshfit.UsageError, r"hshfit\.function\(\)"):
            hshfit.project(lambda wi, wo: 1)

    def test_views_are_read_only_and_keep_their_owner(self):
        values = hshfit.project("lambert", outgoing=4).coefficients.values
        with self.assertRaises(ValueError):
            values[0] = 1
        # The projection is gone; the numbers are those of 1 / pi against the first function,
        # 1 / sqrt(2 pi) on the hemisphere.
        np.testing.assert_allclose(values[:, 0, 0], np.sqrt(2 * np.pi) / np.pi, rtol=1e-9)

    def test_values_can_be_replaced_in_a_copy(self):
        found = hshfit.project("lambert", outgoing=4).coefficients
        halved = found.with_values(found.values / 2)
        np.testing.assert_array_equal(halved.values, found.values / 2)
        with self.assertRaisesRegex(hshfit.UsageError, r"shape \(4, 1, 49\)"):
            found.with_values(np.zeros(3))


class Stopping(program.InFolder):
    # Minutes of work.
    LONG = {"order": 100, "outgoing": "256x256", "tolerance": 1e-11}

    def setUp(self):
        super().setUp()
        self.begun = threading.Event()

    def slow(self, wi, _):
        self.begun.set()
        time.sleep(0.002)
        return np.full(len(wi), 0.1)

    def stop(self, call):
        """A signal, once the work has begun, becomes a KeyboardInterrupt."""
        def interrupt():
            self.begun.wait()
            os.kill(os.getpid(), signal.SIGINT)

        signals = threading.Thread(target=interrupt, daemon=True)
        signals.start()
        with self.assertRaises(KeyboardInterrupt):
            call()
        signals.join()

    def test_interrupt_stops_a_long_projection(self):
        calls = []

        def progress(part, done, total):
            calls.append((part, done, total))
            self.begun.set()

        self.stop(lambda: hshfit.project("ward:ax=0.1,ay=0.3", cosine=True,
                                         progress=progress, **self.LONG))
        # It was stopped long before its end.
        self.assertTrue(calls)
        self.assertLess(calls[-1][1], 256 * 256)

    def test_interrupt_stops_a_function_of_python(self):
        brdf = hshfit.function(self.slow)
        self.stop(lambda: hshfit.project(brdf, **self.LONG))

    def test_work_that_is_stopped_leaves_no_file(self):
        calls = []

        def fails_later(wi, wo):
            calls.append(len(wi))
            if len(calls) > 1000:
                raise RuntimeError("enough")
            return np.full(len(wi), 0.1)

        brdf = hshfit.function(fails_later, isotropic=True)
        with self.assertRaisesRegex(RuntimeError, "enough"):
            brdf.write("big.binary")
        waits = hshfit.function(self.slow, isotropic=True)
        self.stop(lambda: waits.write("big.binary", format="merl"))
        self.assertEqual(os.listdir("."), [])

    def test_learning_ends_after_the_seconds(self):
        specs = [f"lambert:kd={n / 100}+ggx:alpha={0.2 + n / 100},F0=.04" for n in range(1, 9)]
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            library = hshfit.Library.learn(specs, "some.library", components=2, limit=10,
                                           limit_maximum=10, limit_flip=1, seconds=0.01)
        # The functions of libraries alone take longer at their pairs, and two materials are read.
        self.assertGreaterEqual(len(library.names), 2)
        self.assertGreater(len(library.left_out), 0)
        self.assertEqual(len(library.names) + len(library.left_out), len(specs))
        self.assertEqual(library.left_out, [spec for spec in specs if spec in library.left_out])
        self.assertIn(f"{len(library.names)} of {len(specs)} materials", str(said[0].message))
        whole = hshfit.Library.learn(library.left_out, "whole.library", add_to="some.library")
        self.assertEqual((len(whole.names), whole.left_out), (len(specs), []))

    def test_an_exception_of_progress_stops_the_work(self):
        def progress(part, done, total):
            raise RuntimeError("enough")

        with self.assertRaisesRegex(RuntimeError, "enough"):
            hshfit.project("ward:ax=0.1,ay=0.3", cosine=True, progress=progress, **self.LONG)

    def test_progress_comes_on_the_calling_thread_and_ends_at_the_total(self):
        calls = []

        def progress(part, done, total):
            calls.append((part, done, total, threading.get_ident()))

        hshfit.project("ward:ax=0.1,ay=0.3", cosine=True, outgoing="8x8", progress=progress)
        self.assertEqual({call[3] for call in calls}, {threading.get_ident()})
        part, done, total, _ = calls[-1]
        self.assertEqual((part, done), ("project", total))


if __name__ == "__main__":
    program.main()
