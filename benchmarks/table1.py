# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Table 1 of Solomon et al. 2015, reproduced: cost and accuracy of distances, compared with other methods."""

from __future__ import annotations

import tempfile
from importlib.util import find_spec
from statistics import mean

from .processes import measured, reports

SIZES = (693, 1150, 1911, 3176, 5278, 8774, 14584, 100_000, 500_000)
"""Mesh sizes of the paper, and two more."""

_SMOOTH_SIZES = (693, 1911, 3176)
_CASES = "benchmarks.table1_cases"
_PEERS = ("linear_program", "pot", "dense")
# Bytes of a matrix with all pairs; a peer needs two to five times as much.
_LARGEST_MATRIX = 4e9
# Time to start a process and read a matrix.
_START_SECONDS = 20.0

_TIMES = """
CPU seconds per distance between random densities: mean of {trials} trials; of a single one if the mesh has too many
vertices for all pairs; for slow peers, of as many as the time allowed.
A star: more than {limit:.0f} s, or too many pairs.

paths     once per mesh: all pairs of distances along edges (SciPy, Dijkstra), which the next three need
LP        exact transport (POT, emd2)
POT       entropic transport with the dense kernel (POT, sinkhorn2; it stops at 1e-5 in the 2-norm, every 10th time)
dense     the same, in NumPy, to the same error as Convwass
setup     Convwass, once per mesh: Laplacian and factorization
eq. (10)  Convwass: to a marginal error of 1e-5 in the 1-norm, the value of the paper
debiased  Convwass: eq. (10) and the self-distances of the two densities
it.       iterations of POT, dense and eq. (10)
"""

_COSTS = """
Cost and values: squared distances on meshes of unit area. gamma is 1 % of the median of all pairs.

MB        peak memory; before: the part needed for Python, its libraries, the mesh and the densities
ms        one application of the kernel to two columns
bound     ms for reading the factor's numbers from memory as often as needed; caches are faster
LP, POT, dense: exact transport and the cost of entropic plans, both with distances along edges;
eq. (10), debiased: Convwass
"""

_SMOOTH = """
Two densities of two smooth bumps each on a sphere of unit area: squared distances. gamma is 1 % of the median as above,
and the default of Surface.

circles   exact transport with the true distances, great circles
paths     exact transport with distances along edges, which are too long; the reference in the paper
eq. (10)  Convwass, as in the paper
diverg.   debiased, Distance.divergence
value     corrected for the kernel's tail, Distance.value; error of its square root compared with circles
"""


def main(sizes: list[int], trials: int, limit: float) -> None:
    """Run all cases and print three tables.

    Parameters
    ----------
    sizes : list of int
        Numbers of vertices of the meshes.
    trials : int
        Number of random pairs of densities per mesh.
    limit : float
        Seconds for a single distance above which a peer is skipped.
    """
    peers = _PEERS
    if find_spec("ot") is None:
        print(
            "POT is not installed, so the columns LP and POT stay empty; pyproject.toml lists it in the extra `test`."
        )
        peers = ("dense",)
    rows = _times(sizes, trials, limit, peers)
    _print_costs(rows)
    _smooth([size for size in _SMOOTH_SIZES if size <= max(sizes)], limit, peers)


def _times(sizes: list[int], trials: int, limit: float, peers: tuple[str, ...]) -> list[dict[str, object]]:
    print(_TIMES.format(trials=trials, limit=limit))
    heads = f"{'paths':>8} {'LP':>8} {'POT':>8} {'dense':>8}  {'setup':>7} {'eq. (10)':>8} {'debiased':>8}"
    print(f"{'vertices':>8}  {heads}   {'it. POT':>7} {'dense':>6} {'Convwass':>8}")
    rows = []
    living = peers
    for size in sizes:
        row = _row(size, trials, limit, living)
        living = tuple(name for name in living if row[name])
        rows.append(row)
        found = row["noise"]
        seconds = " ".join(_column(_average(row[name], "cpu"), name in peers, 8, 3) for name in _PEERS)
        counts = [
            _column(_average(row[name], "iterations"), name in peers, width, 0)
            for name, width in (("pot", 7), ("dense", 6))
        ]
        print(
            f"{size:8}  {_column(row['paths'], True, 8, 3)} {seconds}  {found['setup']:7.3f} {found['plain']:8.3f} "
            f"{found['debiased']:8.3f}   {counts[0]} {counts[1]} {mean(found['iterations']):8.0f}",
            flush=True,
        )
    return rows


def _row(size: int, trials: int, limit: float, peers: tuple[str, ...]) -> dict[str, object]:
    """Run all cases of one mesh; the reports of peers that did not finish are empty."""
    row: dict[str, object] = {"size": size, "paths": None, **{name: [] for name in _PEERS}}
    has_pairs = 8 * size**2 < _LARGEST_MATRIX
    with tempfile.TemporaryDirectory() as folder:
        measured(_CASES, "shape", count=size, folder=folder)
        if peers and has_pairs:
            paths = measured(_CASES, "paths", trials=trials, folder=folder)
            row["paths"], gamma = paths["cpu"], paths["gamma"]
            for name in peers:
                row[name] = _peer(name, limit, folder=folder, costs="paths", gamma=gamma)
        else:
            gamma = measured(_CASES, "sampled_gamma", folder=folder)["gamma"]
        row["noise"] = measured(_CASES, "noise", trials=trials if has_pairs else 1, gamma=gamma, folder=folder)
    return {**row, "gamma": gamma}


def _peer(case: str, limit: float, **options: object) -> list[dict[str, object]]:
    """Return the reports of a peer's trials; empty if a single trial took too long."""
    # Time for one trial on the largest meshes, or for all trials on the smaller ones.
    found = reports("benchmarks.peer_cases", case, _START_SECONDS + 2.0 * limit, **options)
    return found if found and mean(trial["cpu"] for trial in found) <= limit else []


def _print_costs(rows: list[dict[str, object]]) -> None:
    print(_COSTS)
    print(
        f"{'vertices':>8} {'gamma':>8}  {'MB':>6} {'before':>6} {'ms':>8} {'bound':>8}   "
        f"{'LP':>8} {'POT':>8} {'dense':>8}  {'eq. (10)':>8} {'debiased':>8}"
    )
    for row in rows:
        found = row["noise"]
        values = " ".join(_scientific(_average(row[name], "value")) for name in _PEERS)
        bound = _column(found["bound"], False, 8, 2)
        print(
            f"{row['size']:8} {row['gamma']:8.2e}  {found['peak']:6.0f} {found['before']:6.0f} "
            f"{found['application']:8.2f} {bound}   {values}  {found['entropic_value']:8.2e} {found['value']:8.2e}"
        )
    solvers = sorted({row["noise"]["solver"] for row in rows})
    error = max(row["noise"]["error"] for row in rows)
    print(f"\nSolver: {', '.join(solvers)}; largest marginal error: {error:.1e}")


def _smooth(sizes: list[int], limit: float, peers: tuple[str, ...]) -> None:
    if not sizes:
        return
    print(_SMOOTH)
    print(
        f"{'vertices':>8} {'gamma':>8} {'it.':>4} {'CPU s':>7}   {'circles':>8} {'paths':>8}  "
        f"{'eq. (10)':>9} {'diverg.':>8} {'value':>8} {'error':>7}"
    )
    for size in sizes:
        for gamma in (0.002, None):
            _print_smooth(size, gamma, limit, peers)


def _print_smooth(size: int, gamma: float | None, limit: float, peers: tuple[str, ...]) -> None:
    with tempfile.TemporaryDirectory() as folder:
        found = measured(_CASES, "smooth", count=size, gamma=gamma, folder=folder)
        exact = dict.fromkeys(("circles", "paths"))
        if "linear_program" in peers:
            for costs in exact:
                options = {"folder": folder, "costs": costs, "gamma": found["gamma"]}
                exact[costs] = _average(_peer("linear_program", limit, **options), "value")
    truth = exact["circles"]
    error = "-" if truth is None else f"{100.0 * ((found['value'] / truth) ** 0.5 - 1.0):+.1f} %"
    print(
        f"{size:8} {found['gamma']:8.2e} {found['iterations']:4} {found['cpu']:7.3f}   {_scientific(truth)} "
        f"{_scientific(exact['paths'])}  {found['entropic_value']:9.2e} {found['divergence']:8.2e} "
        f"{found['value']:8.2e} {error:>7}",
        flush=True,
    )


def _average(trials: list[dict[str, object]], name: str) -> float | None:
    return mean(trial[name] for trial in trials) if trials else None


def _column(value: float | None, is_tried: bool, width: int, digits: int) -> str:
    """Format a number, with a star for an unfinished run and a dash for a missing one."""
    return f"{'*' if is_tried else '-':>{width}}" if value is None else f"{value:{width}.{digits}f}"


def _scientific(value: float | None) -> str:
    return f"{'-':>8}" if value is None else f"{value:8.2e}"
