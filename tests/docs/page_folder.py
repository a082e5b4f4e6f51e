"""A folder in which commands of a page run: empty but for examples/, with hshfit on the PATH."""
import contextlib
import os
import tempfile
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]


@contextlib.contextmanager
def page_folder(program, columns):
    """Gives the folder, and the environment with a terminal of so many columns."""
    with tempfile.TemporaryDirectory() as place:
        folder, commands = Path(place) / "folder", Path(place) / "commands"
        folder.mkdir()
        commands.mkdir()
        (commands / "hshfit").symlink_to(program)
        (folder / "examples").symlink_to(TOP / "examples")
        yield folder, os.environ | {"PATH": f"{commands}:{os.environ['PATH']}",
                                    "COLUMNS": str(columns)}
