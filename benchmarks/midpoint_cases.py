# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Convwass's midpoints on surfaces, one case per process: ``python -m benchmarks.midpoint_cases CASE OPTIONS``.

Every case prints one line of JSON. None of them needs Blender.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from convwass_addon.transport import Surface, barycenter, point_distances

from .clock import Clock
from .meshes import blob
from .processes import peak_megabytes, run_case
from .surface_cases import caps, ladder

# Number of values that the kernel is applied to at once.
_VALUES_AT_ONCE = 1 << 22


def own(folder: str, count: int, tolerance: float) -> dict[str, object]:
    """Solve the midpoint; write the masses of the two caps, (2, n), and of the midpoint, (n,), to a folder."""
    mesh = blob(count)
    clock = Clock()
    surface = Surface(*mesh)
    ladder(surface)
    setup = clock.read()["cpu"]
    densities = caps(surface)
    clock = Clock()
    # If both marginals differ from the midpoint by at most half the tolerance, they differ by at most the tolerance.
    found = barycenter(densities, [0.5, 0.5], surface, tolerance=0.5 * tolerance)
    used, peak = clock.read(), peak_megabytes()
    masses = densities * surface.weights
    masses /= masses.sum(axis=1, keepdims=True)
    np.save(Path(folder) / "masses.npy", masses)
    np.save(Path(folder) / "own.npy", found.density * surface.weights)
    return {
        **used,
        "setup": setup,
        "iterations": sum(found.iterations),
        "error": marginals_apart(found.log_v, masses, surface),
        "gamma": surface.gamma,
        "peak": peak,
    }


def costs(folder: str, count: int) -> dict[str, object]:
    """Write the squared distances between all vertices, minus gamma times the logarithm of a column's area, (n, n).

    POT scales exp(-cost / gamma), which thereby contains the vertex area on the barycenter's side as a factor.
    """
    surface = Surface(*blob(count))
    clock = Clock()
    lengths = all_distances(surface)
    used = clock.read()
    np.square(lengths, out=lengths)
    lengths -= surface.gamma * np.log(surface.weights)
    np.save(Path(folder) / "costs.npy", lengths)
    return used


def all_distances(surface: Surface) -> NDArray[np.float64]:
    """Distances between all vertices in lengths of the domain, averaged over both directions, (n, n)."""
    count = surface.shape[0]
    lengths = np.empty((count, count))
    at_once = max(1, _VALUES_AT_ONCE // count)
    for start in range(0, count, at_once):
        sources = np.arange(start, min(start + at_once, count))
        lengths[sources] = point_distances(sources, surface)
    lengths += lengths.T
    lengths *= 0.5 / surface.unit_length
    return lengths


def marginals_apart(log_v: NDArray[np.float64], masses: NDArray[np.float64], surface: Surface) -> float:
    """Return the sum of the differences between the two plans' marginals at the midpoint.

    Parameters
    ----------
    log_v : (2, n)
        Logarithms of the scalings on the barycenter's side; on the other side, the plans have the exact marginals.
    masses : (2, n)
        Masses of the two densities.
    surface : Surface
        With the kernel.
    """
    through = np.empty_like(log_v)
    surface.log_apply(log_v, through)
    log_w = np.log(masses / surface.weights) - through
    surface.log_apply(log_w, through)
    first, second = surface.weights * np.exp(log_v + through)
    return float(np.abs(first - second).sum())


if __name__ == "__main__":
    run_case(own, costs)
