# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Midpoints between two densities on a surface, by POT with a dense distance matrix and by Convwass."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

from .processes import measured, reports

SIZES = (1000, 2500, 5000, 10_000)
"""Numbers of vertices of the meshes."""

_OURS = "benchmarks.midpoint_cases"
_THEIRS = "benchmarks.barycenter_peers"
# Wall seconds allowed per CPU second on a busy machine.
_BUSY = 6.0
_MEGABYTES = 6000

_HEADING = """
Midpoint of two caps on a bumpy shape, plain, to {percent:.0f} % marginal error, double precision, one thread.

setup    CPU s of preparation, once per mesh, not included in CPU s and wall s: for Convwass the Laplacian, its
         factorization and coarser meshes; for POT the distances between all vertices
error    sum of the differences between the marginals of the two plans at the midpoint; POT returns no scalings, so this
         is twice the error it reports, the sum of the two marginals' standard deviations
MB       peak memory, for POT without the setup
L1       distance between the two results, as masses of the vertices
POT receives masses, our gamma, and squared distances measured by our kernel on the same mesh. They are accurate to 5 %
on a sphere; paths along edges would take a quarter of the time and are 5 to 9 % too long. POT has no vertex areas, so
-gamma ln(area) is added to its costs, which makes the areas the reference measure of its plans, as in ours. POT's cost
is quadratic at any distance, while the cost of our kernel becomes linear far away; hence the results differ: with costs
-gamma ln H for our kernel H, L1 was 0.0002 at 2500 vertices. POT tests its error every ten iterations, and is stopped
at {limit:.0f} CPU s (*) and {gigabytes:g} GB. Our iterations include those on all coarser meshes.
"""


def main(sizes: list[int], program: str | Path, limit: float, tolerance: float) -> None:
    """Run all cases and print a table.

    Parameters
    ----------
    sizes : list of int
        Numbers of vertices of the meshes.
    program : str or Path
        A Python with POT.
    limit : float
        CPU seconds allowed for a run of POT.
    tolerance : float
        The marginal error to reach.
    """
    print(_HEADING.format(percent=100 * tolerance, limit=limit, gigabytes=_MEGABYTES / 1000))
    print(
        f"{'vertices':>8}  {'program':16} {'setup':>7} {'CPU s':>8} {'wall s':>8} {'iterations':>10} {'error':>7} "
        f"{'MB':>6} {'L1':>6}"
    )
    for count in sizes:
        with tempfile.TemporaryDirectory() as folder:
            own = measured(_OURS, "own", folder=folder, count=count, tolerance=tolerance)
            _print(count, "Convwass", own, "")
            costs = measured(_OURS, "costs", folder=folder, count=count)
            report = _pot(folder, program, limit, own["gamma"], tolerance)
            apart = "" if "failed" in report else f"{_difference(Path(folder)):6.3f}"
            _print(count, report.get("program", "POT"), {"setup": costs["cpu"], **report}, apart)


def _pot(folder: str, program: str | Path, limit: float, gamma: float, tolerance: float) -> dict[str, object]:
    options = {"folder": folder, "gamma": gamma, "threshold": tolerance, "seconds": limit, "megabytes": _MEGABYTES}
    found = reports(_THEIRS, "pot_dense", _BUSY * limit, program=program, **options)
    return found[-1] if found else {"failed": "*"}


def _difference(folder: Path) -> float:
    own, other = (np.load(folder / name) for name in ("own.npy", "barycenter.npy"))
    return float(np.abs(own / own.sum() - other / other.sum()).sum())


def _print(count: int, name: str, report: dict[str, object], apart: str) -> None:
    """Print the costs and results of a run, or its failure."""
    start = f"{count:8}  {name:16} {report['setup']:7.2f} "
    if "failed" in report:
        print(f"{start}{report['failed']:>8}", flush=True)
        return
    print(
        f"{start}{report['cpu']:8.2f} {report['wall']:8.2f} {report['iterations']:10} {report['error']:7.4f} "
        f"{report['peak']:6.0f} {apart}".rstrip(),
        flush=True,
    )
