# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Barycenters by other programs, one per process: ``python -m benchmarks.barycenter_peers CASE OPTIONS``.

Runs in the peers' environment, so it imports nothing of ours. Every case reads ``densities.npy`` from a folder, writes
``density.npy`` and ``scalings.npy`` (on the barycenter's side) to it, and prints what that took as JSON.
"""

from __future__ import annotations

import json
import math
import os
import sys
import time
from pathlib import Path

import numpy as np

# Read when jax is imported. One thread, as all others have.
os.environ["XLA_FLAGS"] = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
os.environ["JAX_PLATFORMS"] = "cpu"
os.environ["JAX_ENABLE_X64"] = "1"

_INNER = 10


class Clock:
    """Seconds since it was made."""

    def __init__(self) -> None:
        self._cpu, self._wall = time.process_time(), time.perf_counter()

    def read(self) -> dict[str, float]:
        """Return CPU and wall seconds."""
        return {"cpu": time.process_time() - self._cpu, "wall": time.perf_counter() - self._wall}


def ott(folder: Path, sigma: float, threshold: float, debiased: bool, logarithms: bool) -> dict[str, object]:
    """OTT-JAX: FixedBarycenter on a Grid geometry in double precision; stops by its own error."""
    import jax
    from ott.geometry.grid import Grid
    from ott.problems.linear.barycenter_problem import FixedBarycenterProblem
    from ott.solvers.linear.discrete_barycenter import FixedBarycenter

    densities = np.load(folder / "densities.npy")
    # In units in which the longest side is one, as its documentation has it; the kernel is exp(-d^2 / epsilon).
    longest = max(densities.shape[1:])
    axes = [jax.numpy.asarray(np.arange(n) / longest) for n in densities.shape[1:]]
    epsilon = 2.0 * (sigma / longest) ** 2
    problem = FixedBarycenterProblem(Grid(x=axes, epsilon=epsilon), jax.numpy.asarray(densities.reshape(2, -1)))

    def solve(limit):
        options = {"inner_iterations": _INNER, "max_iterations": 2000, "lse_mode": logarithms, "debiased": debiased}
        return jax.block_until_ready(FixedBarycenter(threshold=limit, **options)(problem))

    # The threshold is no part of what is compiled: this compiles, and stops at the first chance.
    clock = Clock()
    solve(1e9)
    start = clock.read()
    clock = Clock()
    found = solve(threshold)
    used = clock.read()
    scalings = np.asarray(found.g)
    log_v = scalings / epsilon if logarithms else _logarithm(scalings)
    _save(folder, np.asarray(found.histogram), log_v, densities.shape)
    rounds = int((np.asarray(found.errors)[:, 0] != -1).sum()) * _INNER
    return {**used, "iterations": rounds, "start": start["cpu"] - used["cpu"] * _INNER / rounds}


def pot(folder: Path, sigma: float, threshold: float, debiased: bool) -> dict[str, object]:
    """POT: convolutional barycenters of images; stops by its own error, tested every ten iterations."""
    import ot

    densities = np.load(folder / "densities.npy")
    method = ot.bregman.convolutional_barycenter2d_debiased if debiased else ot.bregman.convolutional_barycenter2d
    # Its images are one wide from the center of the first cell to that of the last.
    reg = 2.0 * (sigma / (densities.shape[1] - 1)) ** 2
    clock = Clock()
    density, log = method(densities, reg, stopThr=threshold, numItermax=5000, log=True)
    used = clock.read()
    _save(folder, density, _logarithm(log["V"]), densities.shape)
    return {**used, "iterations": int(log["niter"]) + 1, "start": 0.0}


def _logarithm(scalings: np.ndarray) -> np.ndarray:
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.log(scalings)


def _save(folder: Path, density: np.ndarray, log_v: np.ndarray, shape: tuple[int, ...]) -> None:
    np.save(folder / "density.npy", density.reshape(shape[1:]))
    np.save(folder / "scalings.npy", log_v.reshape(shape))


def limit_processor_time(seconds: float) -> None:
    """Have the system end this process after so many CPU seconds, where it can."""
    try:
        import resource
    except ImportError:  # Windows
        return
    resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(seconds), math.ceil(seconds)))


CASES = {"ott": ott, "pot": pot}

if __name__ == "__main__":
    case, options = sys.argv[1], json.loads(sys.argv[2])
    limit_processor_time(options.pop("seconds"))
    try:
        report = CASES[case](Path(options.pop("folder")), **options)
    except Exception as error:  # what a peer cannot do is a row of the table
        report = {"failed": f"{type(error).__name__}: {error}".splitlines()[0]}
    print(json.dumps(report), flush=True)
