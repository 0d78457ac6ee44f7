# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Barycenters by other programs, one per process: ``python -m benchmarks.barycenter_peers CASE OPTIONS``.

Runs in the peers' environment, so it imports nothing that needs the project's own. The grid cases read
``densities.npy`` from a folder and write ``density.npy`` and ``scalings.npy`` (on the barycenter's side) to it; the
surface case reads ``masses.npy`` and ``costs.npy`` and writes ``barycenter.npy``. All print their cost as JSON.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import sys
from pathlib import Path

import numpy as np

from . import geomloss_loop
from .clock import Clock
from .processes import peak_megabytes

# Read when jax is imported. One thread, like all other programs.
os.environ["XLA_FLAGS"] = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
os.environ["JAX_PLATFORMS"] = "cpu"
os.environ["JAX_ENABLE_X64"] = "1"

_INNER = 10
# Logarithm of the smallest normal float64.
_LOWEST = -708.0


def ott(folder: Path, sigma: float, threshold: float, debiased: bool, logarithms: bool) -> dict[str, object]:
    """OTT-JAX: FixedBarycenter on a Grid geometry in double precision; stopped by its own error."""
    import jax
    from ott.geometry.grid import Grid
    from ott.problems.linear.barycenter_problem import FixedBarycenterProblem
    from ott.solvers.linear.discrete_barycenter import FixedBarycenter

    densities = np.load(folder / "densities.npy")
    # Its documentation sets the longest side to one; the kernel is exp(-d^2 / epsilon).
    longest = max(densities.shape[1:])
    axes = [jax.numpy.asarray(np.arange(n) / longest) for n in densities.shape[1:]]
    epsilon = 2.0 * (sigma / longest) ** 2
    problem = FixedBarycenterProblem(Grid(x=axes, epsilon=epsilon), jax.numpy.asarray(densities.reshape(2, -1)))

    def solve(limit):
        options = {"inner_iterations": _INNER, "max_iterations": 2000, "lse_mode": logarithms, "debiased": debiased}
        return jax.block_until_ready(FixedBarycenter(threshold=limit, **options)(problem))

    # The threshold is not compiled in: this run compiles and stops at the first opportunity.
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
    """POT: convolutional barycenters of images; stopped by its own error, tested every ten iterations."""
    import ot

    densities = np.load(folder / "densities.npy")
    method = ot.bregman.convolutional_barycenter2d_debiased if debiased else ot.bregman.convolutional_barycenter2d
    # In POT, images have width 1 from the center of the first cell to the center of the last.
    reg = 2.0 * (sigma / (densities.shape[1] - 1)) ** 2
    clock = Clock()
    density, log = method(densities, reg, stopThr=threshold, numItermax=5000, log=True)
    used = clock.read()
    _save(folder, density, _logarithm(log["V"]), densities.shape)
    return {**used, "iterations": int(log["niter"]) + 1, "start": 0.0}


def pot_dense(folder: Path, gamma: float, threshold: float) -> dict[str, object]:
    """POT: barycenter of two masses by a dense cost matrix, in the log domain if float64 cannot hold the kernel.

    Its error is the sum of the standard deviations of two marginals: half of that of their difference.
    """
    # POT imports whichever of these it finds, and they take memory.
    os.environ["POT_BACKEND_DISABLE_JAX"] = os.environ["POT_BACKEND_DISABLE_PYTORCH"] = "1"
    import ot

    masses, costs = np.load(folder / "masses.npy"), np.load(folder / "costs.npy")
    logarithms = -costs.max() / gamma < _LOWEST
    clock = Clock()
    method = "sinkhorn_log" if logarithms else "sinkhorn"
    mass, log = ot.bregman.barycenter(masses.T, costs, gamma, method=method, stopThr=threshold / 2, log=True)
    used = clock.read()
    np.save(folder / "barycenter.npy", mass)
    name = "POT, log-sum-exp" if logarithms else "POT, kernel"
    found = {"iterations": int(log["niter"]) + 1, "error": 2.0 * float(log["err"][-1])}
    return {**used, **found, "peak": peak_megabytes(), "program": name}


def geomloss(folder: Path, sigma: float, threshold: float) -> dict[str, object]:
    """GeomLoss: debiased barycenter on squares and cubes, coarse to fine; stopped by our error, which is not timed.

    Images are documented; volumes work, too, if the weights get one axis more than documented. Ten iterations for each
    halving of the blur, its default, and as many at the end as needed.
    """
    import torch
    from geomloss._legacy import utils, wasserstein_barycenter_images as images

    torch.set_num_threads(1)
    utils.LazyTensor, utils.keops_available = geomloss_loop.Lines, True
    densities = np.load(folder / "densities.npy")
    cube = geomloss_loop.in_cube(densities)
    side = cube.shape[-1]
    # Only for gradients does its interface allow more iterations at the end. No gradient is computed.
    measures = torch.tensor(cube[None], dtype=torch.float32, requires_grad=True)
    weights = torch.full((1, len(cube), *[1] * (cube.ndim - 3)), 1.0 / len(cube))
    blur = sigma / side
    clock = Clock()
    watch = geomloss_loop.Watch(
        images.barycenter_iteration, utils.softmin_grid, blur=blur, side=side, threshold=threshold, clock=clock
    )
    images.barycenter_iteration = watch
    with contextlib.suppress(geomloss_loop.Reached):
        images.ImagesBarycenter(measures, weights, blur=blur, scaling_N=geomloss_loop.SCALING, backward_iterations=2000)
    used = clock.read()
    inside = [geomloss_loop.out_of_cube(each, densities.shape[1:]) for each in (watch.log_density, watch.log_v)]
    _save(folder, np.exp(inside[0].astype(float)), inside[1].astype(float), densities.shape)
    return {**used, "iterations": watch.iterations, "start": 0.0, "cells": cube.shape[1:]}


def _logarithm(scalings: np.ndarray) -> np.ndarray:
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.log(scalings)


def _save(folder: Path, density: np.ndarray, log_v: np.ndarray, shape: tuple[int, ...]) -> None:
    np.save(folder / "density.npy", density.reshape(shape[1:]))
    np.save(folder / "scalings.npy", log_v.reshape(shape))


def limit_processor_time(seconds: float) -> None:
    """Let the system end this process after this many CPU seconds, if supported."""
    try:
        import resource
    except ImportError:  # Windows
        return
    resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(seconds), math.ceil(seconds)))


def limit_memory(megabytes: float) -> None:
    """Let the system limit this process's memory, if supported."""
    try:
        import resource
    except ImportError:  # Windows
        return
    with contextlib.suppress(ValueError):  # macOS
        resource.setrlimit(resource.RLIMIT_AS, (int(1e6 * megabytes), int(1e6 * megabytes)))


CASES = {"ott": ott, "pot": pot, "pot_dense": pot_dense, "geomloss": geomloss}

if __name__ == "__main__":
    case, options = sys.argv[1], json.loads(sys.argv[2])
    limit_processor_time(options.pop("seconds"))
    megabytes = options.pop("megabytes", None)
    if megabytes is not None:
        limit_memory(megabytes)
    try:
        report = CASES[case](Path(options.pop("folder")), **options)
    except ModuleNotFoundError as error:
        report = {"failed": f"not installed: {error.name}"}
    except MemoryError:
        report = {"failed": "does not fit" if megabytes is None else f"does not fit in {megabytes / 1000:g} GB"}
    except Exception as error:  # a peer's failure becomes a row of the table
        report = {"failed": f"{type(error).__name__}: {error}".splitlines()[0]}
    print(json.dumps(report), flush=True)
