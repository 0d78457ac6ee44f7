#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""All tasks of this project, with one command each.

    python3 run.py demo               morph the sample shapes; writes a .blend, a picture and an animation to out/
    python3 run.py test [ARGS]        run the tests; ARGS go to pytest, such as  -k grid  or  tests/transport
    python3 run.py window --blender PATH    test mouse and keyboard in Blender's window (needs Linux and Xvfb)
    python3 run.py bench [ARGS]       run the benchmarks
    python3 run.py package [ARGS]     build the extension's zip files into dist/ (--help lists the options)
    python3 run.py fuzz [ARGS]        try to break the add-on, for example with  --minutes 10
    python3 run.py gallery [ARGS]     draw the figures of the paper into docs/; takes an hour (--only 7 draws one)
    python3 run.py lint [PATHS]       check the style of the code
    python3 run.py translations       list missing and unused translations
    python3 run.py api                write the API pages in docs/ from the docstrings
    python3 run.py python [ARGS]      start the project's own Python, such as  -m convwass_addon morph --help

The first start creates the folder .venv next to this file and installs Blender's module bpy and the other dependencies
there, which takes about a minute and 1.5 GB. Nothing outside the folder is changed, and your own Blender settings are
neither read nor written. To choose the Python version (and with it the Blender version), put it first:

    python3 run.py --python 3.11 test     Blender 4.5 LTS, in .venv-3.11
    python3 run.py --python 3.13 test     Blender 5.2 LTS, in .venv-3.13
    python3 run.py test --blender 5.0     this Blender (4.5, 5.0, 5.2) and the Python it needs, in .venv-blender-5.0
"""

import sys

if sys.version_info < (3, 9):
    sys.exit("run.py needs Python 3.11 or 3.13, and this is %d.%d. Try: python3.11 run.py" % sys.version_info[:2])

import signal
import subprocess
from pathlib import Path

from tools import pythons

PROJECT = Path(__file__).resolve().parent

COMMANDS = {
    "demo": [["-m", "convwass_addon", "demo"]],
    # One process per test file, in parallel; "-n 0" after the command disables this.
    "test": [["-m", "pytest", "-n", "logical", "--maxprocesses", "4", "--dist", "loadfile", "--no-loadscope-reorder"]],
    "window": [["-m", "tests.window"]],
    "bench": [["-m", "benchmarks"]],
    "package": [["-m", "tools.package"]],
    "fuzz": [["-m", "tests.fuzz"]],
    "gallery": [["docs/gallery.py"]],
    "translations": [["-m", "tools.translations"]],
    "api": [["-m", "tools.api_pages"]],
    "lint": [["-m", "ruff", "check"], ["-m", "ruff", "format", "--check"]],
    "python": [[]],
}
"""The commands with the programs that each runs in order, with the environment's Python."""

INTERRUPTED = 130


def main(arguments):
    """Run the command given by the arguments; return the exit code."""
    if sys.version_info < (3, 11):
        # pyproject.toml can only be read from Python 3.11 on; an older Python can still find a newer one.
        return run_child([pythons.find().path, str(PROJECT / "run.py"), *arguments])
    version, arguments = take_option("--python", pythons.WANTED, arguments)
    if not arguments or arguments[0] in ("-h", "--help", "help"):
        print(__doc__.strip())
        return 0 if arguments else 2
    command, *rest = arguments
    if command == "lint" and any(word.startswith("-") for word in rest):
        print("run.py: lint takes files and folders; for options use  run.py python -m ruff", file=sys.stderr)
        return 2
    if command not in COMMANDS:
        print(f"run.py: there is no command {command!r}; these are: {', '.join(COMMANDS)}", file=sys.stderr)
        return 2
    blender, rest = take_option("--blender", pythons.BLENDERS, rest) if command == "test" else (None, rest)
    environment = prepared_environment(version, blender)
    # Commands run in the project's folder, `python` in the user's current folder.
    folder = None if command == "python" else PROJECT
    for start in COMMANDS[command]:
        code = run_child([str(environment.program), *start, *rest], folder, environment.variables())
        if code:
            return code
    return 0


def take_option(name, known, arguments):
    """Remove an option and its value from the front of the arguments; return the value, or None if not given."""
    if not arguments or arguments[0] != name:
        return None, arguments
    if len(arguments) < 2 or arguments[1] not in known:
        raise pythons.NoPythonError(f"After {name} say one of: {', '.join(known)}")
    return arguments[1], arguments[2:]


def prepared_environment(version, blender):
    """Return the environment for a Python or a Blender version (None: the best available), created if necessary."""
    from tools.environment import Environment, SetupError

    if blender is not None:
        name, wanted = f".venv-blender-{blender}", (pythons.BLENDERS[blender],)
    else:
        name, wanted = (".venv", pythons.WANTED) if version is None else (f".venv-{version}", (version,))
    environment = Environment(PROJECT, PROJECT / name, blender)
    try:
        environment.prepare(wanted)
    except (SetupError, OSError) as error:
        sys.exit(f"\n{error}")
    return environment


def run_child(command, folder=None, variables=None):
    """Run a program to its end and return its exit code; 130 if the user pressed Ctrl-C.

    The terminal also sends Ctrl-C to the program, which may then exit by itself; a second Ctrl-C kills it.
    """
    presses = []
    child = subprocess.Popen(command, cwd=folder, env=variables)

    def interrupt(*_):
        presses.append(True)
        if len(presses) > 1:
            child.kill()

    handlers = {signal.SIGINT: interrupt, signal.SIGTERM: lambda *_: child.terminate()}
    before = {number: signal.signal(number, handler) for number, handler in handlers.items()}
    code = child.wait()
    for number, handler in before.items():
        signal.signal(number, handler)
    if presses:
        return INTERRUPTED
    return code if code >= 0 else 128 - code


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except pythons.NoPythonError as error:
        sys.exit(str(error))
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)
