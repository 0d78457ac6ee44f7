# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Create the project's own Python environment once, and check at every later start that it is still valid."""

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
    ctypes.CDLL("libEGL.so.1")  # Blender loads it for the first render and aborts if it is missing
"""
# Without bytecode on disk, every process would compile the whole project again, and the tests start about fifty.
_DROPPED_VARIABLES = ("PYTHONHOME", "PYTHONPATH", "PYTHONDONTWRITEBYTECODE", "__PYVENV_LAUNCHER__")
_DROPPED_PREFIXES = ("BLENDER_USER_", "BLENDER_SYSTEM_")


class SetupError(Exception):
    """The environment cannot be created; the message says what to do."""


@dataclass(frozen=True)
class Stamp:
    """The record that an environment keeps about itself.

    Attributes
    ----------
    declared : str
        Hash of the dependencies it was made from; empty until it is complete.
    folder : str
        Where it was created; environments cannot be moved.
    distributions : list of str
        The metadata folders of the installed packages, relative to the folder.
    blender_loads : bool
        Whether ``import bpy`` has succeeded before.
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
        Path of the environment, which need not exist yet.
    blender : str or None
        The version of the ``bpy`` module to install, such as ``"5.0"``; None chooses it by the Python version.
    """

    project: Path
    folder: Path
    blender: str | None = None

    @property
    def program(self) -> Path:
        """Path of the environment's Python."""
        return self.folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")

    @property
    def shown(self) -> str:
        """The folder as it appears in messages."""
        return os.path.relpath(self.folder, self.project)

    def variables(self, base: Mapping[str, str] = os.environ) -> dict[str, str]:
        """Return `base` for a program started here, without the user's own Python and Blender settings."""
        kept = {
            name: value
            for name, value in base.items()
            if name not in _DROPPED_VARIABLES and not name.startswith(_DROPPED_PREFIXES)
        }
        return {**kept, "BLENDER_USER_RESOURCES": str(self.folder / "blender-user")}

    def declared(self) -> str:
        """Hash of the declared dependencies."""
        declared = declared_hash(self.project / "pyproject.toml")
        return declared if self.blender is None else f"{declared} with Blender {self.blender}"

    def prepare(self, wanted: Iterable[str] = pythons.WANTED) -> None:
        """Create the environment unless a valid one exists.

        Parameters
        ----------
        wanted : iterable of str
            Python versions to use, best first.

        Raises
        ------
        SetupError, pythons.NoPythonError
            If it cannot be created; the message is for the user.
        """
        if self.is_installed() and self._read_stamp().blender_loads:
            return
        with _locked(self.folder.with_name(self.folder.name + ".lock"), self.shown):
            if not self.is_installed():
                self._install(pythons.find(wanted))
            if not self._read_stamp().blender_loads:
                self._check_blender()

    def is_installed(self) -> bool:
        """Tell whether everything declared was installed here and is still present."""
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
        """Try to import ``bpy`` and to load its rendering library, which fails if a system library is missing.

        The packages stay: once the library is installed, the next start only repeats this check.
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
        return {**self.variables(), "PIP_USER": "0"}  # user settings could make pip install outside the environment

    def _run(self, command: list[str], problem: str) -> None:
        if subprocess.run(command, cwd=self.project, env=self._pip_variables()).returncode:
            raise SetupError(problem)

    def _remove(self) -> None:
        """Remove an earlier environment; refuse to remove anything else."""
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
    """Return a hash of only the dependency declarations in ``pyproject.toml``."""
    declared = tomllib.loads(pyproject.read_text(encoding="utf-8"))
    project = declared["project"]
    names = ("name", "requires-python", "dependencies", "optional-dependencies", "scripts")
    parts = [declared["build-system"], declared.get("tool", {}).get("setuptools"), *map(project.get, names)]
    return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()


def _base_exists(folder: Path) -> bool:
    """Tell whether the Python that an environment was created from is still installed."""
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
    """Hold a lock on a file, so that only one process sets up; the system releases it even if the process crashes."""
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
