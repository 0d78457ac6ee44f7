# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Convwass's part of the peers' benchmark: shapes for all programs, our barycenters, and one error measure."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from convwass_addon.transport import Grid, barycenter

from .measures import edge_width
from .processes import peak_megabytes, run_case

_SHAPES = ("horse", "bird")
# Silhouettes are projections along this axis.
_SIGHT = 1


def volumes(folder: str, cells: int) -> dict[str, object]:
    """Write two voxelized shapes, each of mass one."""
    from .blends import ASSETS, Pair

    pair = Pair.read([ASSETS / f"{name}.ply" for name in _SHAPES], cells, 1.0)
    return _write(Path(folder), pair.densities)


def silhouettes(folder: str, cells: int) -> dict[str, object]:
    """Write the two shapes' silhouettes on a square."""
    from .blends import ASSETS, Pair

    pair = Pair.read([ASSETS / f"{name}.ply" for name in _SHAPES], cells, 1.0)
    flat = pair.densities.max(axis=1 + _SIGHT)
    square = np.zeros((2, cells, cells))
    low = [(cells - n) // 2 for n in flat.shape[1:]]
    square[:, low[0] : low[0] + flat.shape[1], low[1] : low[1] + flat.shape[2]] = flat
    return _write(Path(folder), square)


def own(folder: str, sigma: float, sharpness: float, threshold: float) -> dict[str, object]:
    """Solve one cold barycenter."""
    densities = np.load(Path(folder) / "densities.npy")
    domain = Grid(densities.shape[1:], sigma)
    cpu, wall = time.process_time(), time.perf_counter()
    found = barycenter(densities, [0.5, 0.5], domain, sharpness=sharpness, tolerance=threshold)
    used = {"cpu": time.process_time() - cpu, "wall": time.perf_counter() - wall}
    np.save(Path(folder) / "density.npy", found.density)
    np.save(Path(folder) / "scalings.npy", found.log_v)
    return {**used, "iterations": sum(found.iterations), "start": 0.0, "peak": peak_megabytes()}


def judged(folder: str, sigma: float) -> dict[str, object]:
    """Measure a program's result in the folder: its error by our definition and the width of its border."""
    there = Path(folder)
    densities, density = np.load(there / "densities.npy"), np.load(there / "density.npy")
    log_v = np.load(there / "scalings.npy")
    if not np.isfinite(density).all() or density.max() <= 0 or np.isnan(log_v).any():
        return {"error": None, "edge": None}
    filled = float(np.load(there / "filled.npy").mean())
    error = marginal_error(log_v, density, densities, Grid(density.shape, sigma))
    return {"error": error, "edge": edge_width(density, filled)}


def marginal_error(
    log_v: NDArray[np.float64], density: NDArray[np.float64], densities: NDArray[np.float64], domain: Grid
) -> float:
    """Return how far the barycenter is from being the second marginal of the plans with these scalings.

    With w_i = mu_i / H(v_i), each plan has its input as one marginal; the error is the largest sum |v_i H(w_i) - mu|.
    Constant factors of the kernel cancel.

    Parameters
    ----------
    log_v : (k, *shape)
        Logarithms of the scalings on the barycenter's side.
    density : (*shape)
        The barycenter; normalized here.
    densities : (k, *shape)
        The inputs; normalized here.
    domain : Grid
        With the kernel.
    """
    target = density / density.sum()
    lowest = -1e5
    errors = []
    for logs, mu in zip(np.maximum(log_v, lowest), densities, strict=True):
        through = np.empty_like(logs)
        domain.log_apply_far(logs[None], through[None])
        log_w = np.full_like(logs, lowest)
        log_w[mu > 0] = np.log(mu[mu > 0] / mu.sum()) - through[mu > 0]
        domain.log_apply_far(log_w[None], through[None])
        errors.append(float(np.abs(np.exp(np.minimum(logs + through, 50.0)) - target).sum()))
    return max(errors)


def _write(folder: Path, filled: NDArray[np.floating]) -> dict[str, object]:
    axes = tuple(range(1, filled.ndim))
    sums = filled.sum(axis=axes, keepdims=True, dtype=np.float64)
    np.save(folder / "densities.npy", filled / sums)
    np.save(folder / "filled.npy", sums.reshape(-1))
    return {"shape": filled.shape[1:]}


if __name__ == "__main__":
    run_case(volumes, silhouettes, own, judged)
