# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Finding a Python to create the environment with."""

from __future__ import annotations

import ast
import json
import os
import sys
from pathlib import Path

import pytest

from tools import pythons

posix_only = pytest.mark.skipif(os.name == "nt", reason="stands in for Pythons with shell scripts")


def write_program(path: Path, answer: str) -> Path:
    """Write a program that prints a fixed answer."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!/bin/sh\ncat <<'END'\n{answer}\nEND\n", encoding="utf-8")
    path.chmod(0o755)
    return path


def write_python(path: Path, version: str, **differing: object) -> str:
    """Write a program that identifies itself as Python of this version."""
    told = {
        "version": [int(number) for number in version.split(".")],
        "program": str(path),
        "suitable": True,
        "has_venv": True,
        "has_headers": False,
        **differing,
    }
    return str(write_program(path, json.dumps(told)))


def test_running_python_describes_itself():
    found = pythons.probe(sys.executable)
    assert found.version == ".".join(map(str, sys.version_info[:3]))
    assert found.minor == ".".join(map(str, sys.version_info[:2]))


def test_an_environment_is_replaced_by_its_base_python():
    assert Path(pythons.probe(sys.executable).path).resolve() == Path(sys._base_executable).resolve()


@posix_only
def test_other_programs_are_skipped(tmp_path):
    assert pythons.probe(str(tmp_path / "missing")) is None
    assert pythons.probe(str(write_program(tmp_path / "chatty", "pyenv: python3.13: command not found"))) is None
    silent = write_program(tmp_path / "failing", "")
    silent.write_text("#!/bin/sh\nexit 127\n", encoding="utf-8")
    assert pythons.probe(str(silent)) is None
    assert pythons.probe(write_python(tmp_path / "threaded", "3.13.0", suitable=False)) is None


@posix_only
def test_the_preferred_version_wins_wherever_it_is(tmp_path):
    older = write_python(tmp_path / "older", "3.11.7")
    better = write_python(tmp_path / "better", "3.13.1")
    assert pythons.find(("3.13", "3.11"), [older, better]).path == better
    assert pythons.find(("3.11", "3.13"), [better, older]).path == older


@posix_only
def test_a_python_with_venv_is_preferred(tmp_path):
    bare = write_python(tmp_path / "bare", "3.13.0", has_venv=False)
    complete = write_python(tmp_path / "complete", "3.11.2")
    assert pythons.find(("3.13", "3.11"), [bare, complete]).path == complete


@posix_only
def test_a_missing_venv_is_explained(tmp_path):
    bare = write_python(tmp_path / "bare", "3.11.2", has_venv=False)
    with pytest.raises(pythons.NoPythonError, match=r"apt-get install python3\.11-venv"):
        pythons.find(("3.13", "3.11"), [bare])


@posix_only
def test_no_python_at_all_is_explained(tmp_path):
    other = write_python(tmp_path / "other", "3.12.1")
    with pytest.raises(pythons.NoPythonError, match=r"No Python 3\.13 or 3\.11 was found"):
        pythons.find(("3.13", "3.11"), [other])


@posix_only
def test_usual_folders_are_searched_newest_first(tmp_path):
    on_path = write_python(tmp_path / "bin" / "python3.13", "3.13.1")
    pyenv = [write_python(tmp_path / f".pyenv/versions/{v}/bin/python", v) for v in ("3.13.2", "3.13.10")]
    uv = write_python(tmp_path / ".local/share/uv/python/cpython-3.13.5-linux-x86_64-gnu/bin/python3", "3.13.5")
    write_python(tmp_path / ".pyenv/versions/3.12.1/bin/python", "3.12.1")
    found = list(pythons.candidates("3.13", {"PATH": str(tmp_path / "bin")}, tmp_path))
    ours = [path for path in found if path.startswith(str(tmp_path))]
    assert ours == [on_path, pyenv[1], pyenv[0], uv]
    assert len(set(found)) == len(found)


@posix_only
def test_configured_pyenv_and_uv_folders_are_searched(tmp_path):
    pyenv = write_python(tmp_path / "elsewhere/versions/3.11.9/bin/python", "3.11.9")
    uv = write_python(tmp_path / "pythons/cpython-3.11.9-linux-x86_64-gnu/bin/python3", "3.11.9")
    environ = {"PYENV_ROOT": str(tmp_path / "elsewhere"), "UV_PYTHON_INSTALL_DIR": str(tmp_path / "pythons")}
    assert {pyenv, uv} <= set(pythons.candidates("3.11", environ, tmp_path))


@pytest.mark.parametrize(
    ("file", "oldest"), [("run.py", (3, 7)), ("tools/__init__.py", (3, 7)), ("tools/pythons.py", (3, 9))]
)
def test_modules_for_older_pythons_compile_there(project, file, oldest):
    ast.parse((project / file).read_text(encoding="utf-8"), feature_version=oldest)
