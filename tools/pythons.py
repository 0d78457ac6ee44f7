# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Find a Python for which Blender's module ``bpy`` is built.

Runs on Python 3.9, so that ``run.py`` can hand over from an older Python to the right one.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from .system import as_root

WANTED = ("3.13", "3.11")
"""The Python versions with ``bpy`` wheels, best first."""

BLENDERS = {"5.2": "3.13", "5.0": "3.11", "4.5": "3.11"}
"""The Python version of each Blender version that the project is tested with."""

USUAL_BLENDER = {"3.13": "5.2", "3.11": "4.5"}
"""The default Blender version for each Python version: the newest long-term release."""

_PROBE = """
import importlib.util, json, os, struct, sys, sysconfig
print(json.dumps({
    "version": list(sys.version_info[:3]),
    "program": getattr(sys, "_base_executable", "") or sys.executable,
    "suitable": sys.implementation.name == "cpython" and struct.calcsize("P") == 8
                and not sysconfig.get_config_var("Py_GIL_DISABLED"),
    "has_venv": all(map(importlib.util.find_spec, ("venv", "ensurepip"))),
    "has_headers": os.path.exists(os.path.join(sysconfig.get_path("include"), "Python.h")),
}))
"""


class NoPythonError(Exception):
    """No usable Python was found; the message says how to install one."""


@dataclass(frozen=True)
class Interpreter:
    """A Python on this machine, as reported by itself.

    Attributes
    ----------
    path : str
        The program to start: never the Python of an environment but the one it was created from, because the
        environment may be about to be rebuilt.
    version : str
        Three numbers, for example ``"3.13.0"``.
    has_venv : bool
        Whether it can create environments with pip (a separate package on Debian).
    has_headers : bool
        Whether extension modules can be compiled for it.
    """

    path: str
    version: str
    has_venv: bool
    has_headers: bool

    @property
    def minor(self) -> str:
        """The first two numbers of the version, for example ``"3.13"``."""
        return self.version.rpartition(".")[0]


def probe(path: str) -> Interpreter | None:
    """Ask a Python program for its version; None unless it is a 64-bit CPython with a global interpreter lock."""
    try:
        answer = subprocess.run([path, "-I", "-c", _PROBE], capture_output=True, text=True, timeout=30, check=True)
        told = json.loads(answer.stdout)
    except (OSError, subprocess.SubprocessError, ValueError):
        return None
    if not told["suitable"]:
        return None
    version = ".".join(str(number) for number in told["version"])
    return Interpreter(told["program"], version, told["has_venv"], told["has_headers"])


def find(wanted: Iterable[str] = WANTED, places: Iterable[str] | None = None) -> Interpreter:
    """Return the first Python that has one of the wanted versions and can create environments.

    Parameters
    ----------
    wanted : iterable of str
        Versions, for example ``"3.13"``, best first.
    places : iterable of str, optional
        Programs to try instead of those from `candidates`.

    Raises
    ------
    NoPythonError
        If there is none; the message is for the user.
    """
    wanted = tuple(wanted)
    without_venv = None
    for version in wanted:
        for path in places if places is not None else candidates(version):
            interpreter = probe(path)
            if interpreter is None or interpreter.minor != version:
                continue
            if interpreter.has_venv:
                return interpreter
            without_venv = without_venv or interpreter
    raise NoPythonError(_advice(wanted, without_venv))


def candidates(
    version: str,
    environ: Mapping[str, str] = os.environ,
    home: Path | None = None,
) -> Iterator[str]:
    """Yield the programs on this machine that may be Python `version`, most likely first, each once.

    The running Python comes first, then those on PATH, then the folders that pyenv, uv, Homebrew, python.org's
    installers and Windows' ``py`` launcher use.
    """
    seen = set()
    for path in _places(version, environ, home or Path.home()):
        if path and path not in seen:
            seen.add(path)
            yield path


def _places(version: str, environ: Mapping[str, str], home: Path) -> Iterator[str | None]:
    if "{}.{}".format(*sys.version_info) == version:
        yield sys.executable
    search = environ.get("PATH")
    for name in ("python" + version, "python3", "python"):
        yield shutil.which(name, path=search)
    for folder, pattern in _install_folders(version, environ, home):
        yield from sorted(map(str, folder.glob(pattern)), key=_numbers, reverse=True)
    launcher = shutil.which("py", path=search)
    if launcher:
        yield _ask_launcher(launcher, version)


def _install_folders(version: str, environ: Mapping[str, str], home: Path) -> Iterator[tuple[Path, str]]:
    """Yield folders with glob patterns that match Pythons of that version in them."""
    pyenv = Path(environ.get("PYENV_ROOT") or home / ".pyenv")
    if os.name == "nt":
        local, roaming = Path(environ.get("LOCALAPPDATA", home)), Path(environ.get("APPDATA", home))
        folder = "Python" + version.replace(".", "")
        yield pyenv / "pyenv-win" / "versions", version + ".*/python.exe"
        yield Path(environ.get("UV_PYTHON_INSTALL_DIR") or roaming / "uv" / "python"), f"cpython-{version}.*/python.exe"
        yield local / "Programs" / "Python" / folder, "python.exe"
        yield Path(environ.get("PROGRAMFILES", "C:/Program Files")) / folder, "python.exe"
        return
    data = Path(environ.get("XDG_DATA_HOME") or home / ".local" / "share")
    yield pyenv / "versions", version + ".*/bin/python"
    yield Path(environ.get("UV_PYTHON_INSTALL_DIR") or data / "uv" / "python"), f"cpython-{version}.*/bin/python3"
    yield Path("/Library/Frameworks/Python.framework/Versions") / version, "bin/python3"
    for prefix in ("/opt/homebrew", "/usr/local", "/usr"):
        yield Path(prefix) / "bin", "python" + version


def _numbers(path: str) -> list[int]:
    """Return the numbers in a path, so that 3.13.10 sorts after 3.13.9."""
    return [int(number) for number in re.findall(r"\d+", path)]


def _ask_launcher(launcher: str, version: str) -> str | None:
    """Ask Windows' ``py`` launcher for the path of a version."""
    command = [launcher, "-" + version, "-c", "import sys; print(sys.executable)"]
    try:
        return subprocess.run(command, capture_output=True, text=True, timeout=30, check=True).stdout.strip()
    except (OSError, subprocess.SubprocessError):
        return None


def _advice(wanted: tuple[str, ...], without_venv: Interpreter | None) -> str:
    sudo = as_root()
    if without_venv is not None:
        return (
            f"Python {without_venv.version} at {without_venv.path} would do, but its venv module is not installed.\n"
            f"On Debian and Ubuntu this line installs it; then run the same command again:\n\n"
            f"    {sudo}apt-get install python{without_venv.minor}-venv"
        )
    best = wanted[0]
    return (
        f"No Python {' or '.join(wanted)} was found (64-bit, from python.org, your system, pyenv, uv or Homebrew).\n"
        f"Blender's module bpy exists for these versions only; run.py itself was started by Python "
        f"{'.'.join(map(str, sys.version_info[:3]))}.\n"
        f"Any of these lines installs one; then run the same command again:\n\n"
        f"    {sudo}apt-get install python3.11 python3.11-venv   (Debian 12; Ubuntu with the deadsnakes archive)\n"
        f"    {sudo}apt-get install python3.13 python3.13-venv   (Debian 13, Ubuntu 25.04)\n"
        f"    {sudo}dnf install python{best}                       (Fedora)\n"
        f"    brew install python@{best}                          (macOS)\n"
        f"    winget install Python.Python.{best}                 (Windows)\n"
        f"    uv python install {best}                            (anywhere, with uv)"
    )
