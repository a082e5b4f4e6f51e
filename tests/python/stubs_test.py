"""The type stubs have the names and arguments of the module, and everything is documented."""
import ast
import os
import re
import unittest
from pathlib import Path

import hshfit
import program
import stub_signatures

STUBS = Path(hshfit.__file__).with_name("__init__.pyi")


def arguments_of(node):
    """Names of a stub's arguments without self."""
    given = node.args.posonlyargs + node.args.args + node.args.kwonlyargs
    return [argument.arg for argument in given if argument.arg != "self"]


def arguments_in(doc, name):
    """Names of the arguments in the signature that pybind11 puts first in a docstring."""
    signature = re.match(rf"{re.escape(name)}\((.*?)\) ->", doc, re.DOTALL)
    found = re.findall(r"(?:^|, )(\w+): ", signature[1])
    return [argument for argument in found if argument not in ("self", "arg0")]


class Stubs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        tree = ast.parse(STUBS.read_text(encoding="utf-8"))
        cls.functions = {n.name: n for n in tree.body if isinstance(n, ast.FunctionDef)}
        cls.classes = {n.name: n for n in tree.body if isinstance(n, ast.ClassDef)}

    def test_stubs_have_the_names_of_the_module(self):
        self.assertEqual(sorted([*self.functions, *self.classes]), sorted(hshfit.__all__))

    def test_functions_have_the_arguments_of_their_stubs(self):
        for name, node in self.functions.items():
            with self.subTest(function=name):
                doc = getattr(hshfit, name).__doc__
                self.assertEqual(arguments_in(doc, name), arguments_of(node))

    def test_signatures_with_options_are_those_of_the_module(self):
        stubs = STUBS.read_text(encoding="utf-8")
        self.assertIn("def project(\n", stubs)
        self.assertEqual(stub_signatures.updated(stubs), stubs,
                         "tests/python/stub_signatures.py --update writes them")

    def test_classes_have_the_members_of_their_stubs(self):
        for name, node in self.classes.items():
            if issubclass(getattr(hshfit, name), hshfit.Error):
                self.assertIsInstance(getattr(hshfit, name).exit_code, int)
                continue
            members = {child.name for child in node.body if isinstance(child, ast.FunctionDef)}
            have = {member for member in vars(getattr(hshfit, name))
                    if not member.startswith("_") or member in members}
            with self.subTest(class_name=name):
                self.assertEqual(members, have)

    def test_methods_have_the_arguments_of_their_stubs(self):
        for name, node in self.classes.items():
            for child in node.body:
                if not isinstance(child, ast.FunctionDef):
                    continue
                if any(each.id != "staticmethod" for each in child.decorator_list):
                    continue
                doc = getattr(getattr(hshfit, name), child.name).__doc__
                if child.name in ("_repr_html_", "__len__", "__iter__"):
                    continue
                with self.subTest(method=f"{name}.{child.name}"):
                    self.assertEqual(arguments_in(doc, child.name), arguments_of(child))

    def test_functions_and_classes_are_documented(self):
        for name in hshfit.__all__:
            doc = getattr(hshfit, name).__doc__
            text = doc.split("\n\n", 1)[-1] if doc.startswith(f"{name}(") else doc
            self.assertGreater(len(text.strip()), 30, name)

    def test_the_package_says_that_it_is_typed(self):
        self.assertTrue(os.path.exists(STUBS.with_name("py.typed")))


if __name__ == "__main__":
    program.main()
