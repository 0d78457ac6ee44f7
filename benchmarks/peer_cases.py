# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The peers in the paper's Table 1, one case per process: ``python -m benchmarks.peer_cases CASE OPTIONS``.

Every case prints a line of JSON per trial as soon as the trial is done. They need only NumPy, and some of them POT.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

_TOLERANCE = 1e-5
_ITERATIONS = 10000
Solve = Callable[[NDArray[np.float64], NDArray[np.float64]], tuple[float, int]]


def linear_program(costs: NDArray[np.float64], _gamma: float) -> Solve:
    """Exact transport by POT's network simplex."""
    import ot

    def solve(first, second):
        value, log = ot.emd2(first, second, costs, numItermax=10**8, log=True)
        if log["warning"] is not None:
            raise RuntimeError(log["warning"])
        return value, 0

    return solve


def pot(costs: NDArray[np.float64], gamma: float) -> Solve:
    """POT's Sinkhorn iteration; the value is the cost of the entropic plan without the entropy."""
    import ot

    def solve(first, second):
        value, log = ot.sinkhorn2(first, second, costs, gamma, stopThr=_TOLERANCE, numItermax=_ITERATIONS, log=True)
        return float(value), int(log["niter"])

    return solve


def dense(costs: NDArray[np.float64], gamma: float) -> Solve:
    """[Cuturi 2013] in NumPy; the value is the cost of the entropic plan."""

    def solve(first, second):
        kernel = np.exp(-costs / gamma)
        right = np.ones_like(second)
        blurred = kernel @ right
        iterations, error = 0, np.inf
        while error > _TOLERANCE and iterations < _ITERATIONS:
            iterations += 1
            left = first / blurred
            right = second / (left @ kernel)
            blurred = kernel @ right
            error = np.abs(left * blurred - first).sum()
        kernel *= costs
        return float(left @ (kernel @ right)), iterations

    return solve


def trials(solve: Solve, masses: NDArray[np.float64]) -> Iterator[dict[str, object]]:
    """Yield the cost and the result of every trial."""
    for first, second in masses:
        start = time.process_time()
        value, iterations = solve(first, second)
        yield {"cpu": time.process_time() - start, "value": value, "iterations": iterations}


CASES = {"linear_program": linear_program, "pot": pot, "dense": dense}

if __name__ == "__main__":
    case, options = sys.argv[1], json.loads(sys.argv[2])
    folder = Path(options["folder"])
    solver = CASES[case](np.load(folder / f"{options['costs']}.npy"), options["gamma"])
    for report in trials(solver, np.load(folder / "masses.npy")):
        print(json.dumps(report), flush=True)
