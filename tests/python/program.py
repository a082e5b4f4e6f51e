"""What the tests of the Python package share: the program, run in a folder that goes away."""
import json
import os
import re
import subprocess
import tempfile
import unittest

PROGRAM = os.environ["HSHFIT_PROGRAM"]


def without_calls(document):
    """Without the calls that make a form again, which Python and the program word differently."""
    if isinstance(document, dict):
        return {key: without_calls(value) for key, value in document.items()
                if key not in ("command", "options")}
    return [without_calls(value) for value in document] if isinstance(document, list) else document


class InFolder(unittest.TestCase):
    """A test with a folder of its own, which is the current one."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.before = os.getcwd()
        os.chdir(self.folder.name)

    def tearDown(self):
        os.chdir(self.before)
        self.folder.cleanup()

    def run_program(self, *words):
        """Standard output of the program, which has to succeed. A file that exists is replaced."""
        force = ["--force"] if "-o" in words else []
        done = subprocess.run([PROGRAM, *words, *force, "--quiet"], check=False,
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def bytes_from(self, *words, extension):
        """The file that the program would write, by way of standard output: without a key."""
        done = subprocess.run([PROGRAM, *words, "-o", f"{extension}:-", "--quiet"], check=False,
                              capture_output=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def json_of(self, *words):
        return json.loads(self.run_program(*words, "--json"))

    def refusal(self, *words):
        """Exit code and message of the program, which has to fail."""
        done = subprocess.run([PROGRAM, *words, "--quiet"], check=False, capture_output=True,
                              text=True)
        self.assertNotEqual(done.returncode, 0)
        return done.returncode, done.stderr.strip().removeprefix("hshfit: ")

    def bytes_of(self, path):
        """Of a file, without the key that the program states at the end of JSON
        (docs/reference/files.md)."""
        with open(path, "rb") as file:
            content = file.read()
        return re.sub(rb',(\s*)"made_from": ?\{[^{}]*\}\s*\}\n\Z',
                      lambda found: b"\n}\n" if found[1] else b"}\n", content)


def main():
    unittest.main(verbosity=2)
