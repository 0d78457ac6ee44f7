# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""One cold barycenter by other programs and by Convwass, to the same error by the same measure."""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from tools.environment import SetupError
from tools.peers import PeersEnvironment

from . import midpoints
from .processes import PROJECT, measured, reports

_OURS = "benchmarks.barycenter_cases"
_THEIRS = "benchmarks.barycenter_peers"
TOLERANCE = 0.01
_TRIES = 5
# If a program's own error differs from ours, it is asked for this fraction of the estimated sufficient error.
_SAFETY = 0.8
# Wall seconds allowed per CPU second on a busy machine.
_BUSY = 6.0

_HEADING = """
One cold barycenter of horse and bird, t = 0.5, to {percent:.0f} % marginal error, double
precision (GeomLoss: single), one thread.

start     CPU s of preparation, once per process, such as compiling; not included in CPU s and wall s
error     of the result and the scalings that a program returns, by our measure: the largest sum |v H(w) - mu|
edge      cells over which the density falls from 90 to 10 % of its plateau
The allowed error of each program is lowered until ours is small enough; the row shows only the last run. No program
can start from a neighboring frame as Convwass does, so 24 frames take a peer 24 times as long. * means more than
{limit:.0f} CPU s.
GeomLoss documents only images, but its loop and soft-min work on volumes. It accepts squares and cubes with a power of
two of cells per side, so its rows name the size that the shapes were padded to. Its soft-min uses PyTorch's log-sum-exp
instead of KeOps. Its loop has no stopping rule: it is stopped by our error, which is tested every five iterations and
not timed.
"""

COLUMNS = (
    f"{'cells':>14} {'blur':>5}  {'program':36} {'CPU s':>8} {'wall s':>8} {'start':>6} {'iterations':>10} "
    f"{'error':>7} {'edge':>6}"
)


def main(resolutions: list[int], side: int, sizes: list[int], limit: float) -> None:
    """Run all programs and print tables for volumes, images and surfaces.

    Parameters
    ----------
    resolutions : list of int
        Cells along the longest side of the volumes.
    side : int
        Size of the images in cells.
    sizes : list of int
        Numbers of vertices of the surfaces.
    limit : float
        CPU seconds allowed for a run of a peer.
    """
    program = peers_python()
    runner = Runner(program, limit)
    print(_HEADING.format(percent=100 * TOLERANCE, limit=limit))
    print(COLUMNS)
    for cells in resolutions:
        runner.volumes(cells)
    print(f"{'any':>14} {'any':>5}  {'POT':36} documents no barycenters of volumes")
    print(f"\nThe same of silhouettes, {side} x {side} cells\n\n{COLUMNS}")
    runner.images(side)
    midpoints.main(sizes, program, limit, TOLERANCE)


def peers_python() -> Path:
    """Return a Python with the other programs, installed first if need be; exits if that fails."""
    environment = PeersEnvironment.of(PROJECT)
    try:
        environment.prepare_peers()
    except (SetupError, OSError) as error:
        sys.exit(f"\n{error}")
    return environment.program


class Runner:
    """Runs programs on shapes in a folder and prints a row for each."""

    def __init__(self, program: Path, limit: float) -> None:
        self._program = program
        self._limit = limit

    def volumes(self, cells: int) -> None:
        """Print the rows of volumes."""
        with tempfile.TemporaryDirectory() as folder:
            shape = measured(_OURS, "volumes", folder=folder, cells=cells)["shape"]
            wide, narrow = cells / 40, 1.0
            self._own(folder, shape, wide, (0.0, 1.0))
            for debiased in (False, True):
                self._peer(folder, shape, wide, "ott", debiased, logarithms=False)
            self._geomloss(folder, shape, wide)
            self._own(folder, shape, narrow, (0.0, 0.75, 1.0))
            for debiased in (False, True):
                self._peer(folder, shape, narrow, "ott", debiased, logarithms=False)
            self._peer(folder, shape, narrow, "ott", True, logarithms=True)
            self._geomloss(folder, shape, narrow)

    def images(self, side: int) -> None:
        """Print the rows of silhouettes."""
        with tempfile.TemporaryDirectory() as folder:
            self._beside_pot(folder, side)
            self._geomloss(folder, [side, side], side / 40)

    def beside_pot(self, side: int) -> None:
        """Print the rows of silhouettes for POT and Convwass only."""
        with tempfile.TemporaryDirectory() as folder:
            self._beside_pot(folder, side)

    def _beside_pot(self, folder: str, side: int) -> None:
        shape = measured(_OURS, "silhouettes", folder=folder, cells=side)["shape"]
        self._own(folder, shape, side / 40, (0.0, 1.0))
        for debiased in (False, True):
            self._peer(folder, shape, side / 40, "pot", debiased)

    def _own(self, folder: str, shape: list[int], sigma: float, dial: tuple[float, ...]) -> None:
        for sharpness in dial:

            def run(threshold, sharpness=sharpness):
                return measured(_OURS, "own", folder=folder, sigma=sigma, sharpness=sharpness, threshold=threshold)

            _print(shape, sigma, f"Convwass, sharpness {sharpness:g}", *_to_tolerance(run, folder, sigma))

    def _peer(self, folder: str, shape: list[int], sigma: float, case: str, debiased: bool, **more: object) -> None:
        name = {"ott": "OTT-JAX", "pot": "POT"}[case]
        name += {True: ", log-sum-exp", False: ", kernel"}.get(more.get("logarithms"), "")
        name += ", debiased" if debiased else ""
        _print(shape, sigma, name, *self._found(case, folder, sigma, debiased=debiased, **more))

    def _geomloss(self, folder: str, shape: list[int], sigma: float) -> None:
        name = "GeomLoss, debiased" if len(shape) == 2 else "GeomLoss' soft-min on volumes"
        report, found = self._found("geomloss", folder, sigma)
        _print(report.get("cells", shape), sigma, name, report, found)

    def _found(
        self, case: str, folder: str, sigma: float, **more: object
    ) -> tuple[dict[str, object], dict[str, object]]:
        def run(threshold):
            options = {"folder": folder, "sigma": sigma, "threshold": threshold, "seconds": self._limit, **more}
            found = reports(_THEIRS, case, _BUSY * self._limit, program=self._program, **options)
            return found[-1] if found else {"failed": "*"}

        return _to_tolerance(run, folder, sigma)


def _to_tolerance(run, folder: str, sigma: float) -> tuple[dict[str, object], dict[str, object]]:
    """Lower the program's own allowed error until our measure is small enough."""
    threshold = TOLERANCE
    for _ in range(_TRIES):
        report = run(threshold)
        if "failed" in report:
            return report, {}
        found = measured(_OURS, "judged", folder=folder, sigma=sigma)
        if found["error"] is None or found["error"] <= TOLERANCE:
            break
        threshold *= _SAFETY * TOLERANCE / found["error"]
    return report, found


def _print(shape: list[int], sigma: float, name: str, report: dict[str, object], found: dict[str, object]) -> None:
    """Print the costs and results of a run, or its failure."""
    start = f"{' x '.join(map(str, shape)):>14} {sigma:5.2f}  {name:36} "
    if "failed" in report:
        print(f"{start}{report['failed']:>8}", flush=True)
        return
    used = f"{report['cpu']:8.2f} {report['wall']:8.2f} {report['start']:6.1f} {report['iterations']:10} "
    ends = "    NaN, and stops as if it had converged" if found["error"] is None else _judgement(found)
    print(f"{start}{used}{ends}", flush=True)


def _judgement(found: dict[str, object]) -> str:
    return f"{found['error']:7.4f} {found['edge']:6.2f}"
