# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Make the project's own Python environment once, and know at the next start that it is still right."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import shutil
import subprocess
import sys
import time
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import IO

from . import pythons, system

_STAMP = "convwass.json"
_LOAD_BLENDER = """
import ctypes, sys
import bpy
if sys.platform == "linux":
    ctypes.CDLL("libEGL.so.1")  # Blender opens it at the first picture, and aborts without it
"""
# Without bytecode on disk every process compiles all of the project again, and the tests start some fifty.
_DROPPED_VARIABLES = ("PYTHONHOME", "PYTHONPATH", "PYTHONDONTWRITEBYTECODE", "__PYVENV_LAUNCHER__")
_DROPPED_PREFIXES = ("BLENDER_USER_", "BLENDER_SYSTEM_")


class SetupError(Exception):
    """The environment cannot be made; the message says what to do about it."""


@dataclass(frozen=True)
class Stamp:
    """What an environment says about itself.

    Attributes
    ----------
    declared : str
        Hash of the dependencies it was made from; empty while it is being made.
    folder : str
        Where it was made: environments do not survive being moved.
    distributions : list of str
        The records of the installed packages, relative to the folder.
    blender_loads : bool
        Whether ``import bpy`` has been seen to work.
    """

    declared: str = ""
    folder: str = ""
    distributions: list[str] = field(default_factory=list)
    blender_loads: bool = False


@dataclass(frozen=True)
class Environment:
    """A folder with a Python and the project's dependencies.

    Attributes
    ----------
    project : Path
        The folder that holds ``pyproject.toml``.
    folder : Path
        Where the environment is, or will be.
    blender : str or None
        The Blender whose module it has, such as ``"5.0"``; None leaves it to the Python.
    """

    project: Path
    folder: Path
    blender: str | None = None

    @property
    def program(self) -> Path:
        """The environment's Python."""
        return self.folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")

    @property
    def shown(self) -> str:
        """The folder as messages name it."""
        return os.path.relpath(self.folder, self.project)

    def variables(self, base: Mapping[str, str] = os.environ) -> dict[str, str]:
        """Return `base` for a program started here: nothing of the user's own Python or Blender settings gets in."""
        kept = {
            name: value
            for name, value in base.items()
            if name not in _DROPPED_VARIABLES and not name.startswith(_DROPPED_PREFIXES)
        }
        return {**kept, "BLENDER_USER_RESOURCES": str(self.folder / "blender-user")}

    def declared(self) -> str:
        """Hash of the dependencies that belong in here."""
        declared = declared_hash(self.project / "pyproject.toml")
        return declared if self.blender is None else f"{declared} with Blender {self.blender}"

    def prepare(self, wanted: Iterable[str] = pythons.WANTED) -> None:
        """Make the environment, unless it is there and still right.

        Parameters
        ----------
        wanted : iterable of str
            Python versions to make it from, best first.

        Raises
        ------
        SetupError, pythons.NoPythonError
            If it cannot be made; the message is for the user.
        """
        if self.is_installed() and self._read_stamp().blender_loads:
            return
        with _locked(self.folder.with_name(self.folder.name + ".lock"), self.shown):
            if not self.is_installed():
                self._install(pythons.find(wanted))
            if not self._read_stamp().blender_loads:
                self._check_blender()

    def is_installed(self) -> bool:
        """Tell whether all that is declared was installed here and has not been taken away since."""
        stamp = self._read_stamp()
        return (
            stamp.declared == self.declared()
            and stamp.folder == str(self.folder)
            and self.program.exists()
            and _base_exists(self.folder)
            and all((self.folder / record).exists() for record in stamp.distributions)
        )

    def _install(self, interpreter: pythons.Interpreter) -> None:
        start = time.monotonic()
        blender = self.blender or pythons.USUAL_BLENDER[interpreter.minor]
        _say(f"Setting up {self.shown} with Python {interpreter.version} ({interpreter.path}) and Blender {blender}.")
        _say("This happens once. It downloads about 500 MB and takes one to four minutes.")
        self._remove()
        self.folder.mkdir(parents=True)
        self._write_stamp(Stamp())
        _say("  making the environment (a few seconds)")
        self._run([interpreter.path, "-m", "venv", str(self.folder)], "Making the environment failed.")
        _say("  installing Blender's module bpy, the numerical packages and the test tools (one to three minutes)")
        self._run(
            [*self._pip_install(quiet=not sys.stdout.isatty()), "--editable", ".[blender,test]", f"bpy=={blender}.*"],
            "Installing failed; pip's message is above. The first start needs a network; try again once it is there.\n"
            "Blender's module bpy exists for Linux and Windows on x86-64 and for macOS.",
        )
        self._install_cholmod(interpreter)
        self._write_stamp(
            Stamp(
                declared=self.declared(),
                folder=str(self.folder),
                distributions=self._installed_records(),
            )
        )
        _say(f"  done in {time.monotonic() - start:.0f} seconds")

    def _installed_records(self) -> list[str]:
        records = self.folder.glob("**/site-packages/*.dist-info")
        return sorted(record.relative_to(self.folder).as_posix() for record in records)

    def _install_cholmod(self, interpreter: pythons.Interpreter) -> None:
        missing = system.missing_for_cholmod(interpreter.has_headers)
        if missing:
            lines = system.install_lines(system.CHOLMOD_APT, system.CHOLMOD_DNF)
            _say(f"  leaving out scikit-sparse, which stands in for cholespy: {' and '.join(missing)} not found.")
            _say(
                f"  cholespy is used where it has a wheel. To have it, run this line and delete {self.shown}:\n{lines}"
            )
            return
        _say("  compiling scikit-sparse, which speeds up large meshes (about a minute)")
        log = self.folder / "scikit-sparse.log"
        with open(log, "wb") as output:
            command = [*self._pip_install(quiet=False), "--editable", ".[cholmod]"]
            failed = subprocess.run(
                command, cwd=self.project, env=self._pip_variables(), stdout=output, stderr=subprocess.STDOUT
            ).returncode
        if failed:
            _say(f"  it could not be compiled (see {self.shown}/{log.name}); cholespy is used instead")

    def _check_blender(self) -> None:
        """Try to load Blender's module and what it renders with, which fails where the system lacks a library.

        The packages stay: once the library is there, the next start only repeats this check.
        """
        _say("  loading Blender's module bpy once (a few seconds)")
        command = [self.program, "-c", _LOAD_BLENDER]
        attempt = subprocess.run(command, env=self.variables(), stderr=subprocess.PIPE, text=True, errors="replace")
        if attempt.returncode:
            raise SetupError(_why_blender_fails(attempt.stderr, attempt.returncode))
        stamp = self._read_stamp()
        self._write_stamp(Stamp(**{**asdict(stamp), "blender_loads": True}))

    def _pip_install(self, *, quiet: bool) -> list[str]:
        options = ["--quiet"] if quiet else []
        return [str(self.program), "-m", "pip", "install", "--disable-pip-version-check", "--no-input", *options]

    def _pip_variables(self) -> dict[str, str]:
        return {**self.variables(), "PIP_USER": "0"}  # some settings make pip install outside the environment

    def _run(self, command: list[str], problem: str) -> None:
        if subprocess.run(command, cwd=self.project, env=self._pip_variables()).returncode:
            raise SetupError(problem)

    def _remove(self) -> None:
        """Remove what is left of an earlier environment, but nothing that is not one."""
        if self.folder.is_symlink():
            self.folder.unlink()
        if not self.folder.exists():
            return
        is_ours = any((self.folder / name).exists() for name in (_STAMP, "pyvenv.cfg"))
        if not is_ours and (not self.folder.is_dir() or any(self.folder.iterdir())):
            raise SetupError(f"{self.folder} is in the way and is not a Python environment. Rename it, then try again.")
        _say(f"  removing the earlier {self.shown}: unfinished, damaged, out of date or made by another tool")
        try:
            shutil.rmtree(self.folder)
        except OSError as error:
            raise SetupError(
                f"{self.folder} could not be removed: {error}\nClose the programs that use it, then try again."
            ) from error

    def _read_stamp(self) -> Stamp:
        try:
            return Stamp(**json.loads((self.folder / _STAMP).read_text(encoding="utf-8")))
        except (OSError, ValueError, TypeError):
            return Stamp()

    def _write_stamp(self, stamp: Stamp) -> None:
        unfinished = self.folder / (_STAMP + ".new")
        unfinished.write_text(json.dumps(asdict(stamp), indent=1), encoding="utf-8")
        unfinished.replace(self.folder / _STAMP)


def declared_hash(pyproject: Path) -> str:
    """Return a hash of what ``pyproject.toml`` says about dependencies, and of nothing else in it."""
    declared = tomllib.loads(pyproject.read_text(encoding="utf-8"))
    project = declared["project"]
    names = ("name", "requires-python", "dependencies", "optional-dependencies", "scripts")
    parts = [declared["build-system"], declared.get("tool", {}).get("setuptools"), *map(project.get, names)]
    return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()


def _base_exists(folder: Path) -> bool:
    """Tell whether the Python that an environment was made from is still installed."""
    try:
        lines = (folder / "pyvenv.cfg").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return False
    homes = [line.partition("=")[2].strip() for line in lines if line.partition("=")[0].strip() == "home"]
    return bool(homes) and Path(homes[0]).is_dir()


def _why_blender_fails(error_output: str, code: int) -> str:
    reason = error_output.strip().splitlines()[-1] if error_output.strip() else f"it ended with code {code}"
    if "cannot open shared object file" not in reason:
        return f"Blender's module bpy does not load here:\n\n    {reason}"
    lines = system.install_lines(system.BLENDER_APT, system.BLENDER_DNF)
    return (
        f"Blender's module bpy needs libraries that this system lacks:\n\n    {reason}\n\n"
        f"This line installs them; then run the same command again:\n\n{lines}"
    )


@contextlib.contextmanager
def _locked(path: Path, shown: str) -> Iterator[None]:
    """Hold a file locked, so that one start at a time sets up; the system lets go of it however the holder ends."""
    with open(path, "a+b") as handle:
        if not _try_lock(handle):
            _say(f"Another start is setting up {shown}; waiting for it.")
            while not _try_lock(handle):
                time.sleep(0.5)
        yield


def _try_lock(handle: IO[bytes]) -> bool:
    try:
        if os.name == "nt":
            import msvcrt

            handle.seek(0)
            msvcrt.locking(handle.fileno(), msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):
        return False
    return True


def _say(text: str) -> None:
    print(text, flush=True)
