# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Flat morphs: seconds of all frames, and one barycenter beside POT to the same error."""

from __future__ import annotations

import sys
from pathlib import Path

from tools.environment import SetupError
from tools.peers import PeersEnvironment

from .peers import COLUMNS, TOLERANCE, Runner
from .processes import PROJECT, measured

_HEADING = """
{frames} frames from one shape to another: rasterizing, solving, outlines and where matter comes from. Two threads of
ours, one of BLAS in each; fit is for Bezier curves of all frames, within 0.15 cells.

{cells:>6}  {name:18} {cpu:>8} {wall:>8} {fit:>8} {points:>7} {fitted:>7} {sigma:>6} {megabytes:>6}"""
_PEERS = "\nOne cold barycenter of silhouettes, t = 0.5, to {percent:.0f} % marginal error, one thread\n"


def main(resolutions: list[int], frames: int, side: int, limit: float, program: Path | None = None) -> None:
    """Print a table of morphs, and one of silhouettes beside POT.

    Parameters
    ----------
    resolutions : list of int
        Cells along the longest side of the morphs.
    frames : int
        From one shape to the other.
    side : int
        Of the silhouettes, in cells.
    limit : float
        CPU seconds that a run of a peer may take.
    program : Path, optional
        A Python that has POT; by default an environment for it is made.
    """
    names = ("cells", "name", "cpu", "wall", "fit", "points", "fitted", "sigma", "megabytes")
    titles = ("cells", "shapes", "CPU s", "wall s", "fit s", "points", "fitted", "blur", "MB")
    print(_HEADING.format(frames=frames, **dict(zip(names, titles, strict=True))))
    for cells in resolutions:
        for name in ("A to heart", "ring to star", "two to three"):
            row = measured("benchmarks.flat_cases", "frames", name=name, cells=cells, count=frames)
            print(
                f"{cells:6}  {name:18} {row['cpu']:8.2f} {row['wall']:8.2f} {row['fit']:8.2f} {row['points']:7.0f} "
                f"{row['fitted']:7.0f} {row['sigma']:6.2f} {row['peak']:6.0f}",
                flush=True,
            )
    print(_PEERS.format(percent=100 * TOLERANCE))
    print(COLUMNS)
    if program is None:
        environment = PeersEnvironment.of(PROJECT)
        try:
            environment.prepare_peers()
        except (SetupError, OSError) as error:
            sys.exit(f"\n{error}")
        program = environment.program
    Runner(program, limit).beside_pot(side)
