# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Run cases in processes of their own with one BLAS thread, so that CPU seconds and peak memory are theirs alone."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NoReturn

PROJECT = Path(__file__).resolve().parent.parent


def measured(module: str, case: str, **options: object) -> dict[str, object]:
    """Run one case in a fresh process and return its report, or exit with its error message."""
    try:
        command = _command(sys.executable, module, case, options)
        done = subprocess.run(command, check=True, **_surroundings())
    except subprocess.CalledProcessError as error:
        sys.exit(f"benchmark {case} {options} failed:\n{error.stderr}")
    return json.loads(done.stdout.strip().splitlines()[-1])


def reports(
    module: str, case: str, limit: float, *, program: str | Path = sys.executable, **options: object
) -> list[dict[str, object]]:
    """Return the lines that a case printed within `limit` seconds, or before it ran out of memory.

    Parameters
    ----------
    module, case
        As on the command line: ``python -m MODULE CASE OPTIONS``.
    limit : float
        Wall seconds allowed.
    program : str or Path
        The Python to run.
    options
        Options of the case.
    """
    command = _command(program, module, case, options)
    try:
        done = subprocess.run(command, timeout=limit, check=False, **_surroundings())
    except subprocess.TimeoutExpired as expired:
        output = expired.stdout or ""
        output = output if isinstance(output, str) else output.decode()
        # Drop what follows the last line break: it is incomplete.
        return [json.loads(line) for line in output.split("\n")[:-1]]
    if done.returncode > 0 and "MemoryError" not in done.stderr:
        sys.exit(f"benchmark {case} {options} failed:\n{done.stderr}")
    return [json.loads(line) for line in done.stdout.splitlines()]


def run_case(*cases: Callable[..., dict[str, object]]) -> NoReturn:
    """Run the case that the command line names, print its report, and end the process."""
    name, options = sys.argv[1:]
    chosen = {case.__name__: case for case in cases}[name]
    print(json.dumps(chosen(**json.loads(options)), default=str), flush=True)
    # Blender 4.5 may wait forever for one of its own threads if the process ends normally.
    os._exit(0)


def peak_megabytes() -> float:
    """Return the peak resident memory of this process; Blender itself takes about 300 of it."""
    try:
        import resource
    except ImportError:  # Windows
        return float("nan")
    scale = 1.0 if sys.platform == "darwin" else 1024.0
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * scale / 1e6


def _command(program: str | Path, module: str, case: str, options: dict[str, object]) -> list[str]:
    return [str(program), "-m", module, case, json.dumps(options)]


def _surroundings() -> dict[str, object]:
    threads = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    return {"env": {**os.environ, **threads}, "cwd": PROJECT, "capture_output": True, "text": True}
