#!/usr/bin/env python3
"""complete_in_shell.py SHELL PROGRAM: presses Tab in a real shell.

bash and zsh run on a pseudo-terminal with the script that PROGRAM prints for them; a stand-in named
hshfit writes down the words that it is called with. fish is asked for its completions, which it
prints. Prints each line that did not become what it should, and ends with 1 if there is one.
"""
import os
import pty
import subprocess
import sys
import tempfile
from pathlib import Path

# What is typed after "hshfit ", and the word that its last word becomes.
CASES = [
    ("proj", "project"),
    ("project oren", "oren-nayar"),
    ("project ggx:alph", "ggx:alpha="),
    ("project ward:ax=.2,vari", "ward:ax=.2,variant="),
    ("project ward:ax=.2,ay=.3,variant=due", "ward:ax=.2,ay=.3,variant=duer"),
    ("project lambert+oren", "lambert+oren-nayar"),
    ("info preset:ngan-ward/blue-acry", "preset:ngan-ward/blue-acrylic"),
    ("info measu", "measured.binary"),
    ("eval lambert --pairs dire", "directions.csv"),
    ("project lambert --toler", "--tolerance"),
    ("project lambert --basis makhotkin-f", "makhotkin-flux"),
    ("project lambert --basis=zern", "--basis=zernike"),
    ("project lambert --files js", "json"),
    ("report lambert --bases hsh,zern", "hsh,zernike"),
    ("compare lambert lambert --metrics nega", "negativity"),
    ("export ward.json --target view", "viewer"),
    ("light preeth", "preetham"),
    ("light hosek-wilkie:turb", "hosek-wilkie:turbidity="),
    ("light sky:elev", "sky:elevation="),
    ("help exit", "exit-codes"),
]


def stand_in(folder, program):
    """A folder for PATH with a program that completes as the real one and writes down its words."""
    binaries = folder / "bin"
    binaries.mkdir()
    script = binaries / "hshfit"
    script.write_text('#!/bin/sh\n[ "$1" != completion ] || exec "%s" "$@"\n'
                      'for word; do :; done\nprintf "%%s\\n" "$word" >>"%s"\n'
                      % (program, folder / "words"))
    script.chmod(0o755)
    return binaries


def on_terminal(command, lines, folder, environment):
    """Types the lines into the shell and waits for its end."""
    child, terminal = pty.fork()
    if child == 0:
        os.chdir(folder)
        os.execvpe(command[0], command, environment)
    seen = b""
    # A line is typed when the one before has been carried out.
    for k, line in enumerate(lines):
        os.write(terminal, line.encode() + b"\r")
        mark = b"done-%d-done" % k
        os.write(terminal, b"printf 'done-%%s-done\\n' %d\r" % k)
        while mark not in seen:
            seen += os.read(terminal, 65536)
    os.write(terminal, b"exit\r")
    try:
        while os.read(terminal, 65536):
            pass
    except OSError:
        pass  # the other end is closed
    os.waitpid(child, 0)


def completed(shell, program, folder):
    """The last words of the lines of CASES after Tab."""
    (folder / "measured.binary").touch()
    (folder / "directions.csv").touch()
    binaries = stand_in(folder, program)
    environment = dict(os.environ, PATH="%s:%s" % (binaries, os.environ["PATH"]), TERM="dumb",
                       HOME=str(folder), COLUMNS="200")
    if shell == "fish":
        answers = []
        for typed, _ in CASES:
            script = "hshfit completion fish | source; complete -C %s" % \
                ("'hshfit " + typed + "'")
            out = subprocess.run(["fish", "--no-config", "-c", script], cwd=folder,
                                 env=environment, capture_output=True, text=True, check=True)
            answers.append(" | ".join(line.split("\t")[0] for line in out.stdout.splitlines()))
        return answers
    command = {"bash": ["bash", "--norc", "--noprofile", "-i"], "zsh": ["zsh", "-f", "-i"]}[shell]
    begin = {"bash": ["source <(hshfit completion bash)"],
             "zsh": ["autoload -Uz compinit && compinit -u -D", "source <(hshfit completion zsh)"]}
    lines = begin[shell] + ["hshfit %s\t" % typed for typed, _ in CASES]
    on_terminal(command, lines, folder, environment)
    words = (folder / "words").read_text() if (folder / "words").exists() else ""
    return words.splitlines()


def main():
    shell, program = sys.argv[1], os.path.abspath(sys.argv[2])
    with tempfile.TemporaryDirectory() as folder:
        answers = completed(shell, program, Path(folder))
    failures = 0
    for k, (typed, expected) in enumerate(CASES):
        answer = answers[k] if k < len(answers) else "nothing"
        if answer != expected:
            print("%s: 'hshfit %s' became '%s', not '%s'" % (shell, typed, answer, expected))
            failures += 1
    if len(answers) != len(CASES):
        print("%s: %d answers to %d lines" % (shell, len(answers), len(CASES)))
        failures += 1
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
