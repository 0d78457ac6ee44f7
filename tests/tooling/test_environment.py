# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""When the environment is ready, how it is set up if not, and the messages."""

from __future__ import annotations

import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest

from tools import environment as environments, pythons, system
from tools.environment import Environment, SetupError, declared_hash

PYPROJECT = """
[build-system]
requires = ["setuptools>=77"]

[project]
name = "convwass"
version = "0.1.0"
dependencies = ["numpy>=1.26"]

[tool.ruff]
line-length = 120
"""
THIS_PYTHON = pythons.Interpreter(sys.executable, "3.13.0", has_venv=True, has_headers=False)


@pytest.fixture
def environment(tmp_path: Path) -> Environment:
    """An environment that does not exist yet, for a project in its own folder."""
    (tmp_path / "pyproject.toml").write_text(PYPROJECT, encoding="utf-8")
    return Environment(tmp_path, tmp_path / ".venv")


@pytest.fixture
def steps(environment: Environment, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The setup steps, recorded as they run; slow ones are replaced by fakes."""
    taken = []

    def run(command: list[str], **options: object) -> subprocess.CompletedProcess:
        if command[1] == "-c":
            return subprocess.CompletedProcess(command, 0, stderr="")
        taken.append(command[2])
        if command[2] == "venv":
            folder = Path(command[3])
            program = Environment(folder.parent, folder).program
            program.parent.mkdir(parents=True)
            program.symlink_to(sys.executable)
            home = Path(sys.executable).resolve().parent
            (folder / "pyvenv.cfg").write_text(f"home = {home}\nversion = 3.13.0\n", encoding="utf-8")
        else:
            records = Path(command[0]).parents[1] / "lib/python3.13/site-packages"
            (records / "numpy-2.0.dist-info").mkdir(parents=True)
        return subprocess.CompletedProcess(command, 0)

    monkeypatch.setattr(environments, "subprocess", SimpleNamespace(run=run, PIPE=subprocess.PIPE))
    monkeypatch.setattr(pythons, "find", lambda wanted: THIS_PYTHON)
    monkeypatch.setattr(system, "missing_for_cholmod", lambda has_headers: ["a C compiler"])
    return taken


def interrupt(monkeypatch: pytest.MonkeyPatch, step: str, with_what: Callable[[], object]) -> None:
    """Run a function before a setup step; it may raise, or return the result of the step."""
    run = environments.subprocess.run

    def interrupted(command: list[str], **options: object) -> object:
        answer = with_what() if step in command[1:3] else None
        return answer or run(command, **options)

    monkeypatch.setattr(environments.subprocess, "run", interrupted)


@pytest.fixture
def made(environment: Environment, steps: list[str]) -> Environment:
    """An environment that was set up, with an empty record of steps."""
    environment.prepare()
    steps.clear()
    return environment


def test_first_start_sets_up_and_the_second_does_nothing(environment, steps, capsys):
    environment.prepare()
    assert steps == ["venv", "pip"]
    said = capsys.readouterr().out
    assert "This happens once" in said
    assert "minutes" in said
    assert "stands in for cholespy" in said
    environment.prepare()
    assert steps == ["venv", "pip"]
    assert capsys.readouterr().out == ""


def test_changed_dependencies_are_reinstalled(made, steps):
    pyproject = made.project / "pyproject.toml"
    pyproject.write_text(PYPROJECT.replace("numpy>=1.26", "numpy>=2"), encoding="utf-8")
    made.prepare()
    assert steps == ["venv", "pip"]


def test_other_settings_in_pyproject_change_nothing(made, steps):
    pyproject = made.project / "pyproject.toml"
    before = declared_hash(pyproject)
    pyproject.write_text(PYPROJECT.replace("120", "100").replace("0.1.0", "0.2.0"), encoding="utf-8")
    assert declared_hash(pyproject) == before
    made.prepare()
    assert steps == []


def test_a_moved_project_is_set_up_again(made, steps):
    there = made.project.with_name("there")
    shutil.copytree(made.project, there, symlinks=True)
    Environment(there, there / ".venv").prepare()
    assert steps == ["venv", "pip"]
    assert made.is_installed()


@pytest.mark.parametrize(
    "damage",
    [
        lambda made: made.program.unlink(),
        lambda made: (made.folder / "pyvenv.cfg").write_text("home = /no/longer/there\n", encoding="utf-8"),
        lambda made: (made.folder / "lib/python3.13/site-packages/numpy-2.0.dist-info").rmdir(),
        lambda made: (made.folder / "convwass.json").write_text("{half", encoding="utf-8"),
        lambda made: (made.folder / "convwass.json").unlink(),
        lambda made: shutil.rmtree(made.folder),
    ],
    ids=["no program", "its Python is gone", "package taken away", "half a stamp", "made by another tool", "removed"],
)
def test_damaged_environment_is_rebuilt(made, steps, damage):
    damage(made)
    made.prepare()
    assert steps == ["venv", "pip"]
    assert made.is_installed()


@pytest.mark.parametrize("interrupted_at", ["venv", "pip"])
def test_interrupted_setup_starts_over(environment, steps, monkeypatch, interrupted_at):
    def stop():
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        interrupt(patch, interrupted_at, stop)
        with pytest.raises(KeyboardInterrupt):
            environment.prepare()
    assert not environment.is_installed()
    environment.prepare()
    assert steps[-2:] == ["venv", "pip"]
    assert environment.is_installed()


def test_other_folders_are_never_removed(environment, steps):
    environment.folder.mkdir()
    precious = environment.folder / "thesis.txt"
    precious.write_text("years", encoding="utf-8")
    with pytest.raises(SetupError, match="in the way"):
        environment.prepare()
    assert precious.read_text(encoding="utf-8") == "years"


def test_a_missing_library_is_named_and_only_the_check_is_repeated(environment, steps, monkeypatch):
    missing = "ImportError: libX11.so.6: cannot open shared object file: No such file or directory"
    for tool, line in (("apt-get", "apt-get install -y libx11-6"), ("dnf", "dnf install -y libX11")):
        with monkeypatch.context() as patch:
            patch.setattr(shutil, "which", lambda name, tool=tool: "/usr/bin/" + name if name == tool else None)
            interrupt(patch, "-c", lambda: subprocess.CompletedProcess([], 1, stderr=missing))
            with pytest.raises(SetupError) as raised:
                environment.prepare()
        assert "libX11.so.6" in str(raised.value)
        assert line in str(raised.value)
    environment.prepare()
    assert steps == ["venv", "pip"]


def test_both_commands_are_shown_on_an_unknown_system(monkeypatch):
    monkeypatch.setattr(shutil, "which", lambda name: None)
    lines = system.install_lines("libx11-6", "libX11").splitlines()
    assert ["apt-get" in lines[0], "dnf" in lines[1]] == [True, True]


def test_other_failures_of_blender_are_explained(environment, steps, monkeypatch):
    interrupt(monkeypatch, "-c", lambda: subprocess.CompletedProcess([], 1, stderr="ImportError: GLIBC_2.28 not found"))
    with pytest.raises(SetupError, match=r"does not load here:\s+ImportError: GLIBC_2\.28 not found"):
        environment.prepare()


def test_only_one_process_sets_up_at_a_time(environment, steps, monkeypatch, capsys):
    """A second process starts during the setup by the first, and then finds it complete."""
    second, said = threading.Thread(target=environment.prepare), []

    def begin_again():
        second.start()
        until = time.monotonic() + 30
        while not any("waiting for it" in text for text in said) and time.monotonic() < until:
            said.append(capsys.readouterr().out)
            time.sleep(0.01)

    with monkeypatch.context() as patch:
        interrupt(patch, "venv", begin_again)
        environment.prepare()
        second.join()
    assert "Another start is setting up .venv; waiting for it." in "".join(said)
    assert steps == ["venv", "pip"]


def test_the_users_own_settings_are_excluded(environment):
    base = {
        "PATH": "/usr/bin",
        "PYTHONPATH": "/opt/ros",
        "PYTHONHOME": "/opt/python",
        "PYTHONDONTWRITEBYTECODE": "1",
        "BLENDER_USER_RESOURCES": "/home/me/blender",
        "BLENDER_USER_SCRIPTS": "/home/me/scripts",
        "BLENDER_SYSTEM_SCRIPTS": "/studio/scripts",
    }
    assert environment.variables(base) == {
        "PATH": "/usr/bin",
        "BLENDER_USER_RESOURCES": str(environment.folder / "blender-user"),
    }


def test_cholmod_is_tried_only_with_all_its_prerequisites(tmp_path, monkeypatch):
    monkeypatch.setenv("SUITESPARSE_INCLUDE_DIR", str(tmp_path))
    monkeypatch.setattr(shutil, "which", lambda name: "/usr/bin/cc")
    assert "Python's headers" in system.missing_for_cholmod(has_python_headers=False)
    (tmp_path / "cholmod.h").touch()
    assert system.missing_for_cholmod(has_python_headers=True) == []
    monkeypatch.setattr(shutil, "which", lambda name: None)
    assert system.missing_for_cholmod(has_python_headers=True) == ["a C compiler"]
