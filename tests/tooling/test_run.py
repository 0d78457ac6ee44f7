# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line of run.py: started programs, exit codes and messages."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time

import pytest
import yaml

import run
from tools import pythons, system
from tools.environment import Environment


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch) -> list[tuple]:
    """The programs that run.py starts, recorded instead of started; each ends with code 0."""
    starts = []
    monkeypatch.setattr(Environment, "prepare", lambda self, wanted: starts.append((self.folder.name, *wanted)))
    monkeypatch.setattr(
        run, "run_child", lambda command, folder=None, variables=None: starts.append((command[1:], folder)) or 0
    )
    return starts


def test_help_names_every_command(capsys):
    assert run.main(["--help"]) == 0
    said = capsys.readouterr().out
    assert all(f"run.py {command}" in said for command in run.COMMANDS)


def test_no_command_shows_the_help_and_fails(capsys):
    assert run.main([]) == 2
    assert "run.py demo" in capsys.readouterr().out


def test_unknown_command_is_refused_before_anything_is_set_up(capsys, started):
    assert run.main(["tset"]) == 2
    assert "no command 'tset'" in capsys.readouterr().err
    assert started == []


def test_arguments_are_passed_on_unchanged(started, project):
    assert run.main(["test", "-k", "grid and not slow", "--help"]) == 0
    assert started == [
        (".venv", "3.13", "3.11"),
        ([*run.COMMANDS["test"][0], "-k", "grid and not slow", "--help"], project),
    ]


def test_lint_accepts_paths_and_no_options(capsys, started, project):
    """Options of one program are invalid for the other."""
    assert run.main(["lint", "tests", "run.py"]) == 0
    assert started[1:] == [([*start, "tests", "run.py"], project) for start in run.COMMANDS["lint"]]
    started.clear()
    assert run.main(["lint", "--fix"]) == 2
    assert "files and folders" in capsys.readouterr().err
    assert started == []


def test_python_starts_in_the_users_folder(started):
    run.main(["python", "-c", "1"])
    assert started[-1] == (["-c", "1"], None)


def test_a_requested_version_has_its_own_environment(started):
    run.main(["--python", "3.11", "lint"])
    assert started[0] == (".venv-3.11", "3.11")


@pytest.mark.parametrize("arguments", [["--python"], ["--python", "3.12", "test"]])
def test_version_without_blender_is_refused(arguments, started):
    with pytest.raises(pythons.NoPythonError, match=r"one of: 3\.13, 3\.11"):
        run.main(arguments)


@pytest.mark.parametrize(("blender", "python"), [("4.5", "3.11"), ("5.0", "3.11"), ("5.2", "3.13")])
def test_a_requested_blender_has_its_own_environment(started, blender, python):
    run.main(["test", "--blender", blender, "-k", "grid"])
    assert started[0] == (f".venv-blender-{blender}", python)
    assert started[1][0] == [*run.COMMANDS["test"][0], "-k", "grid"]


@pytest.mark.parametrize("arguments", [["test", "--blender"], ["test", "--blender", "3.6"]])
def test_an_unsupported_blender_is_refused(arguments, started):
    with pytest.raises(pythons.NoPythonError, match=r"one of: 5\.2, 5\.0, 4\.5"):
        run.main(arguments)
    assert started == []


def test_the_window_test_receives_the_blender_to_open(started):
    run.main(["window", "--blender", "/opt/blender"])
    assert started[-1][0] == ["-m", "tests.window", "--blender", "/opt/blender"]


def test_first_failure_ends_the_command(monkeypatch, started):
    monkeypatch.setattr(run, "run_child", lambda *start: started.append(start) or 3)
    assert run.main(["lint"]) == 3
    assert len(started) == 2


@pytest.mark.parametrize("code", [0, 1, 5, 77])
def test_exit_codes_are_passed_on(code):
    assert run.run_child([sys.executable, "-c", f"raise SystemExit({code})"]) == code


@pytest.mark.skipif(os.name == "nt", reason="signals are POSIX")
def test_a_killed_program_gives_the_shells_exit_code():
    program = "import os, signal; os.kill(os.getpid(), signal.SIGKILL)"
    assert run.run_child([sys.executable, "-c", program]) == 128 + signal.SIGKILL


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signal_handlers_are_restored_once_the_program_has_ended(number):
    before = signal.getsignal(number)

    def own(*_):
        """The caller's own handler."""

    signal.signal(number, own)
    try:
        run.run_child([sys.executable, "-c", ""])
        assert signal.getsignal(number) is own
    finally:
        signal.signal(number, before)


@pytest.mark.skipif(os.name == "nt", reason="signals are POSIX")
def test_an_interrupt_gives_130_and_lets_the_program_clean_up(project, tmp_path):
    tidy = tmp_path / "tidied"
    program = f"""
import sys, time
print("started", flush=True)
try:
    time.sleep(60)
except KeyboardInterrupt:
    time.sleep(0.5)
    open({str(tidy)!r}, "w").close()
    sys.exit(2)
"""
    # A shell that starts the tests in the background makes them ignore the signal, and so would these two.
    heed = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"
    caller = f"{heed}; import sys, run; sys.exit(run.run_child([sys.executable, '-c', {program!r}]))"
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    process = subprocess.Popen([sys.executable, "-c", caller], cwd=project, start_new_session=True, **pipes)
    with process:
        assert process.stdout.readline() == b"started\n"
        time.sleep(0.2)  # until the caller waits for the program
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does on Ctrl-C
        _, errors = process.communicate(timeout=30)
    assert process.returncode == run.INTERRUPTED
    assert errors == b""
    assert tidy.exists()


def test_the_ci_installs_the_system_packages_of_run_py(project):
    script = (project / ".ci" / "run").read_text(encoding="utf-8")
    installed = script.partition("packages=(")[2].partition(")")[0].split()
    assert installed == ["python3-venv", *system.BLENDER_APT.split(), *system.CHOLMOD_APT.split()]
    assert script.rstrip().splitlines()[-1].startswith("python3 run.py test")


def test_the_workflow_runs_both_commands_on_every_system_with_every_python(project):
    workflow = yaml.safe_load((project / ".github" / "workflows" / "tests.yml").read_text(encoding="utf-8"))
    job = workflow["jobs"]["test"]
    matrix = job["strategy"]["matrix"]
    assert sorted(matrix["python"]) == sorted(pythons.WANTED)
    assert [name.partition("-")[0] for name in matrix["system"]] == ["ubuntu", "windows", "macos"]
    commands = [step["run"] for step in job["steps"] if "run" in step]
    assert "system.BLENDER_APT, system.CHOLMOD_APT" in commands[0]
    assert commands[1:] == [f"python run.py --python ${{{{ matrix.python }}}} {name}" for name in ("lint", "test")]


def test_run_py_can_be_started_from_anywhere(tmp_path, project):
    command = [sys.executable, str(project / "run.py"), "help"]
    answer = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert answer.returncode == 0
    assert "run.py demo" in answer.stdout
