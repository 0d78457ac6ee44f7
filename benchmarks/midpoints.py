# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Halfway between two densities on a surface, by a dense matrix of all distances and by ours."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

from .processes import measured, reports

SIZES = (1000, 2500, 5000, 10_000)
"""Vertices of the meshes."""

_OURS = "benchmarks.midpoint_cases"
_THEIRS = "benchmarks.barycenter_peers"
# Wall seconds that a CPU second may take on a machine that has other work.
_BUSY = 6.0
_MEGABYTES = 6000

_HEADING = """
Halfway between two caps on a bumpy shape, plain, to {percent:.0f} % marginal error, double precision, one thread.

setup    CPU s that come first and once per mesh, not in CPU s and wall s: for ours the Laplacian, its factorization
         and coarser meshes, for POT the distances between all vertices
error    sum of the difference of the marginals of the two plans that meet halfway; POT returns no scalings, and this
         is twice what it reports, the sum of the two marginals' standard deviations
MB       peak memory, without that of the setup for POT
L1       between the two results, as masses of the vertices
POT gets masses, our gamma, and squared distances that our kernel measures on the same mesh. They are within 5 % on a
sphere; paths along edges take a quarter of the time and are 5 to 9 % too long. POT knows no areas of vertices, so
-gamma ln(area) is added to its costs; its plans have the areas as their reference then, as ours have. Its cost stays
quadratic far away, where that of our kernel turns linear, and this is why the results differ: by costs of
-gamma ln H, for our kernel H, L1 was 0.0002 at 2500 vertices. It tests its error at every tenth iteration, and is
stopped at {limit:.0f} CPU s (*) and {gigabytes:g} GB. Our iterations are those on all coarser meshes, too.
"""


def main(sizes: list[int], program: str | Path, limit: float, tolerance: float) -> None:
    """Run all cases and print a table.

    Parameters
    ----------
    sizes : list of int
        Vertices of the meshes.
    program : str or Path
        Python with POT.
    limit : float
        CPU seconds that a run of POT may take.
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
            apart = "" if "failed" in report else f"{_apart(Path(folder)):6.3f}"
            _print(count, report.get("program", "POT"), {"setup": costs["cpu"], **report}, apart)


def _pot(folder: str, program: str | Path, limit: float, gamma: float, tolerance: float) -> dict[str, object]:
    options = {"folder": folder, "gamma": gamma, "threshold": tolerance, "seconds": limit, "megabytes": _MEGABYTES}
    found = reports(_THEIRS, "pot_dense", _BUSY * limit, program=program, **options)
    return found[-1] if found else {"failed": "*"}


def _apart(folder: Path) -> float:
    own, other = (np.load(folder / name) for name in ("own.npy", "barycenter.npy"))
    return float(np.abs(own / own.sum() - other / other.sum()).sum())


def _print(count: int, name: str, report: dict[str, object], apart: str) -> None:
    """Print what a run took and found; what went wrong instead where something did."""
    start = f"{count:8}  {name:16} {report['setup']:7.2f} "
    if "failed" in report:
        print(f"{start}{report['failed']:>8}", flush=True)
        return
    print(
        f"{start}{report['cpu']:8.2f} {report['wall']:8.2f} {report['iterations']:10} {report['error']:7.4f} "
        f"{report['peak']:6.0f} {apart}".rstrip(),
        flush=True,
    )
