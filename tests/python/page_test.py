"""The blocks of docs/reference/python.md run in their order, and their comments "= VALUE" are
true."""
import ast
import os
import re
import unittest
from pathlib import Path

import program

PAGE = Path(os.environ["HSHFIT_SOURCE"]) / "docs" / "reference" / "python.md"


def shown(value, text):
    """The value as the text has it: numbers to as many digits."""
    if re.fullmatch(r"-?\d+\.\d+", text):
        return f"{float(value):.{len(text.partition('.')[2])}f}"
    return repr(value)


class Page(program.InFolder):
    def expectations(self, source):
        """Line number of an expression to the text of its value."""
        found = {}
        for number, line in enumerate(source.split("\n"), 1):
            comment = re.search(r"# = (.+)$", line)
            if comment:
                found[number] = comment[1]
        return found

    def run_statements(self, statements, expected, names):
        """Runs statements; values of expressions with a comment are compared."""
        checked = 0
        for node in statements:
            if isinstance(node, ast.Try):
                # What an exception is caught for is looked at as well.
                caught = None
                try:
                    self.execute(node.body, names)
                except Exception as error:  # pylint: disable=broad-except
                    caught = error
                handler = node.handlers[0]
                kind = eval(ast.unparse(handler.type), names)
                self.assertIsInstance(caught, kind)
                names[handler.name] = caught
                checked += self.run_statements(handler.body, expected, names)
            elif isinstance(node, ast.Expr) and node.end_lineno in expected:
                value = eval(compile(ast.Expression(node.value), str(PAGE), "eval"), names)
                text = expected[node.end_lineno]
                with self.subTest(expression=ast.unparse(node)):
                    self.assertEqual(shown(value, text), text)
                checked += 1
            else:
                self.execute([node], names)
        return checked

    def execute(self, statements, names):
        exec(compile(ast.Module(statements, []), str(PAGE), "exec"), names)

    def test_blocks_run_and_values_are_as_stated(self):
        blocks = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(encoding="utf-8"),
                            re.DOTALL | re.MULTILINE)
        self.assertGreater(len(blocks), 5)
        names, checked, stated = {}, 0, 0
        for block in blocks:
            expected = self.expectations(block)
            stated += len(expected)
            checked += self.run_statements(ast.parse(block).body, expected, names)
        self.assertEqual(checked, stated)


if __name__ == "__main__":
    unittest.main(verbosity=2)
