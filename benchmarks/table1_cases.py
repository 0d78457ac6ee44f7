# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Convwass's side of Table 1, one case per process: ``python -m benchmarks.table1_cases CASE OPTIONS``.

Every case prints one line of JSON. None of them needs Blender.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import diags_array
from scipy.sparse.csgraph import dijkstra

from convwass_addon.transport import Distance, Surface, distance

from .meshes import blob, bumps, edge_graph, great_circle_distances, random_densities, sphere
from .processes import peak_megabytes, run_case

_GAMMA_PER_MEDIAN_COST = 0.01
_SOURCES = 50
_READ_BYTES = 1 << 29


def shape(count: int, folder: str) -> dict[str, object]:
    """Write a mesh to a folder, in a separate case because creating it takes more memory than the others."""
    vertices, faces = blob(count)
    np.save(Path(folder) / "vertices.npy", vertices)
    np.save(Path(folder) / "faces.npy", faces)
    return {}


def paths(trials: int, folder: str) -> dict[str, object]:
    """Write the peers' input to a folder: all-pairs costs along edges and masses of random densities."""
    vertices, faces = _read_shape(folder)
    graph = edge_graph(vertices, faces)
    start = time.process_time()
    costs = dijkstra(graph)
    cpu = time.process_time() - start
    np.square(costs, out=costs)
    np.save(Path(folder) / "paths.npy", costs)
    _save_masses(random_densities(len(vertices), trials), Surface(vertices, faces), Path(folder))
    return {"cpu": cpu, "gamma": _GAMMA_PER_MEDIAN_COST * float(np.median(costs))}


def sampled_gamma(folder: str) -> dict[str, object]:
    """Estimate gamma from a few vertices if there are too many for all pairs."""
    vertices, faces = _read_shape(folder)
    sources = np.random.default_rng(0).integers(len(vertices), size=_SOURCES)
    lengths = dijkstra(edge_graph(vertices, faces), indices=sources)
    return {"gamma": _GAMMA_PER_MEDIAN_COST * float(np.median(lengths**2))}


def noise(trials: int, gamma: float, folder: str) -> dict[str, object]:
    """Solve distances between random densities; times and values are means over the trials."""
    vertices, faces = _read_shape(folder)
    densities = random_densities(len(vertices), trials)
    before = peak_megabytes()
    start = time.process_time()
    surface = Surface(vertices, faces, gamma=gamma)
    setup = time.process_time() - start
    plain, plain_cpu = _solved(surface, densities, debias=False)
    debiased, debiased_cpu = _solved(surface, densities, debias=True)
    return {
        "setup": setup,
        "plain": plain_cpu,
        "debiased": debiased_cpu,
        "iterations": [found.iterations for found in plain],
        "error": max(found.marginal_error for found in plain + debiased),
        "entropic_value": float(np.mean([found.value for found in plain])),
        "value": float(np.mean([found.value for found in debiased])),
        "numerics": plain[0].numerics,
        "solver": surface.solver,
        "before": before,
        "peak": peak_megabytes(),
        "application": 1e3 * _best(lambda: surface.apply(densities[0])),
        "bound": _bound(surface),
    }


def smooth(count: int, gamma: float | None, folder: str) -> dict[str, object]:
    """Solve one distance between smooth densities on a sphere; write the peers' input to a folder."""
    vertices, faces = sphere(count)
    surface = Surface(vertices, faces, gamma=gamma)
    densities = bumps(vertices)
    _save_masses(densities[None], surface, Path(folder))
    np.save(Path(folder) / "circles.npy", great_circle_distances(vertices) ** 2)
    np.save(Path(folder) / "paths.npy", dijkstra(edge_graph(vertices, faces)) ** 2)
    start = time.process_time()
    found = distance(*densities, surface)
    return {
        "cpu": time.process_time() - start,
        "gamma": surface.gamma,
        "iterations": found.iterations,
        "entropic_value": found.entropic_value,
        "divergence": found.divergence,
        "value": found.value,
    }


def _read_shape(folder: str) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    return np.load(Path(folder) / "vertices.npy"), np.load(Path(folder) / "faces.npy")


def _save_masses(densities: NDArray[np.float64], surface: Surface, folder: Path) -> None:
    """Write the mass of every vertex, (trials, 2, n); each density sums to one."""
    masses = densities * surface.weights
    np.save(folder / "masses.npy", masses / masses.sum(axis=-1, keepdims=True))


def _solved(surface: Surface, densities: NDArray[np.float64], *, debias: bool) -> tuple[list[Distance], float]:
    start = time.process_time()
    found = [distance(*pair, surface, debias=debias) for pair in densities]
    return found, (time.process_time() - start) / len(found)


def _best(action: Callable[[], object]) -> float:
    """Return the CPU seconds of the fastest of five runs."""
    seconds = []
    for _ in range(5):
        start = time.process_time()
        action()
        seconds.append(time.process_time() - start)
    return min(seconds)


def _bound(surface: Surface) -> float | None:
    """Estimate the milliseconds for reading the factor's numbers from memory as often as one application does.

    A solve reads the factor twice, forward and backward, for all columns at once. None without CHOLMOD, which counts
    the numbers of the factor in the ordering with the least fill.
    """
    try:
        from sksparse.cholmod import cholesky
    except ImportError:
        return None
    stiffness = surface.laplacian.matrix
    system = diags_array(surface.weights) + (surface.gamma / 4.0 / surface.steps) * stiffness
    entries = cholesky(system.tocsc(), mode="simplicial", ordering_method="nesdis").L().nnz
    large = np.ones(_READ_BYTES // 8)
    bytes_per_second = _READ_BYTES / _best(lambda: large @ large)
    return 1e3 * surface.steps * 2 * 8 * entries / bytes_per_second


if __name__ == "__main__":
    run_case(shape, paths, sampled_gamma, noise, smooth)
