# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""When the environment counts as ready, what is done where it does not, and what it says."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

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
    """An environment that is not made yet, for a project in a folder of its own."""
    (tmp_path / "pyproject.toml").write_text(PYPROJECT, encoding="utf-8")
    return Environment(tmp_path, tmp_path / ".venv")


@pytest.fixture
def steps(environment: Environment, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The steps that setting up takes, as they are taken; the slow ones are stood in for."""
    taken = []

    def run(self: Environment, command: list[str], problem: str) -> None:
        taken.append(command[2])
        if command[2] == "venv":
            self.program.parent.mkdir(parents=True)
            self.program.symlink_to(sys.executable)
            home = Path(sys._base_executable).parent
            (self.folder / "pyvenv.cfg").write_text(f"home = {home}\nversion = 3.13.0\n", encoding="utf-8")
        else:
            (self.folder / "lib/python3.13/site-packages/numpy-2.0.dist-info").mkdir(parents=True)

    monkeypatch.setattr(Environment, "_run", run)
    monkeypatch.setattr(pythons, "find", lambda wanted: THIS_PYTHON)
    monkeypatch.setattr(system, "missing_for_cholmod", lambda has_headers: ["a C compiler"])
    monkeypatch.setattr(environments, "_LOAD_BLENDER", "pass")
    return taken


@pytest.fixture
def made(environment: Environment, steps: list[str]) -> Environment:
    """An environment that was set up, with the record of the steps empty again."""
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


def test_changed_dependencies_are_installed_anew(made, steps):
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


def test_moved_project_is_set_up_anew(made, steps):
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
def test_interrupted_setting_up_starts_over(environment, steps, monkeypatch, interrupted_at):
    run = Environment._run

    def interrupted(self, command, problem):
        if command[2] == interrupted_at:
            raise KeyboardInterrupt
        run(self, command, problem)

    with monkeypatch.context() as patch:
        patch.setattr(Environment, "_run", interrupted)
        with pytest.raises(KeyboardInterrupt):
            environment.prepare()
    assert not environment.is_installed()
    environment.prepare()
    assert steps[-2:] == ["venv", "pip"]
    assert environment.is_installed()


def test_what_is_no_environment_is_left_alone(environment, steps):
    environment.folder.mkdir()
    precious = environment.folder / "thesis.txt"
    precious.write_text("years", encoding="utf-8")
    with pytest.raises(SetupError, match="in the way"):
        environment.prepare()
    assert precious.read_text(encoding="utf-8") == "years"


def test_missing_library_is_named_and_only_looked_for_again(environment, steps, monkeypatch):
    missing = "raise ImportError('libX11.so.6: cannot open shared object file: No such file or directory')"
    monkeypatch.setattr(environments, "_LOAD_BLENDER", missing)
    for tool, line in (("apt-get", "apt-get install -y libx11-6"), ("dnf", "dnf install -y libX11")):
        monkeypatch.setattr(shutil, "which", lambda name, tool=tool: "/usr/bin/" + name if name == tool else None)
        with pytest.raises(SetupError) as raised:
            environment.prepare()
        assert "libX11.so.6" in str(raised.value)
        assert line in str(raised.value)
    monkeypatch.setattr(environments, "_LOAD_BLENDER", "pass")
    environment.prepare()
    assert steps == ["venv", "pip"]


def test_both_lines_are_shown_where_the_system_is_unknown(monkeypatch):
    monkeypatch.setattr(shutil, "which", lambda name: None)
    lines = system.install_lines("libx11-6", "libX11").splitlines()
    assert ["apt-get" in lines[0], "dnf" in lines[1]] == [True, True]


def test_blender_that_fails_otherwise_says_why(environment, steps, monkeypatch):
    monkeypatch.setattr(environments, "_LOAD_BLENDER", "raise ImportError('GLIBC_2.28 not found')")
    with pytest.raises(SetupError, match=r"does not load here:\s+ImportError: GLIBC_2\.28 not found"):
        environment.prepare()


def test_one_start_at_a_time_sets_up(tmp_path):
    path = tmp_path / ".venv.lock"
    with environments._locked(path, ".venv"), open(path, "a+b") as second:
        assert not environments._try_lock(second)
    with open(path, "a+b") as third:
        assert environments._try_lock(third)


def test_the_users_own_settings_stay_out(environment):
    base = {
        "PATH": "/usr/bin",
        "PYTHONPATH": "/opt/ros",
        "PYTHONHOME": "/opt/python",
        "BLENDER_USER_RESOURCES": "/home/me/blender",
        "BLENDER_USER_SCRIPTS": "/home/me/scripts",
        "BLENDER_SYSTEM_SCRIPTS": "/studio/scripts",
    }
    assert environment.variables(base) == {
        "PATH": "/usr/bin",
        "BLENDER_USER_RESOURCES": str(environment.folder / "blender-user"),
    }


def test_cholmod_is_tried_only_with_all_that_it_needs(tmp_path, monkeypatch):
    monkeypatch.setenv("SUITESPARSE_INCLUDE_DIR", str(tmp_path))
    monkeypatch.setattr(shutil, "which", lambda name: "/usr/bin/cc")
    assert "Python's headers" in system.missing_for_cholmod(has_python_headers=False)
    (tmp_path / "cholmod.h").touch()
    assert system.missing_for_cholmod(has_python_headers=True) == []
    monkeypatch.setattr(shutil, "which", lambda name: None)
    assert system.missing_for_cholmod(has_python_headers=True) == ["a C compiler"]
