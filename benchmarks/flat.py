# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Flat morphs: seconds for all frames, and one barycenter compared with POT at the same error."""

from __future__ import annotations

from pathlib import Path

from .peers import COLUMNS, TOLERANCE, Runner, peers_python
from .processes import measured

_HEADING = """
{frames} frames from one shape to another: rasterizing, solving, outlines and origins of the material. Our code uses two
threads with one BLAS thread each; fit means Bezier curves for all frames, within 0.15 cells.

{cells:>6}  {name:18} {cpu:>8} {wall:>8} {fit:>8} {points:>7} {fitted:>7} {sigma:>6} {megabytes:>6}"""
_PEERS = "\nOne cold barycenter of silhouettes, t = 0.5, to {percent:.0f} % marginal error, one thread\n"


def main(resolutions: list[int], frames: int, side: int, limit: float, peer_python: Path | None = None) -> None:
    """Print a table of morphs, and one of silhouettes compared with POT.

    Parameters
    ----------
    resolutions : list of int
        Cells along the longest side of the morphs.
    frames : int
        Number of frames from one shape to the other.
    side : int
        Size of the silhouettes in cells.
    limit : float
        CPU seconds allowed for a run of a peer.
    peer_python : Path, optional
        A Python with POT; by default an environment is created for it.
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
    Runner(peers_python() if peer_python is None else peer_python, limit).beside_pot(side)
