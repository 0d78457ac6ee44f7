# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shape keys from one mesh to another shape, compared with Blender's own tools."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from .mesh_measures import MeshFigures
from .processes import measured

PAIRS = ("man walks", "man raises arm", "dog rears", "horse to cow", "hand points", "man to ogre")
"""Pairs of one build that may be used for choosing parameters."""

_HEADING = """
The mesh of the first shape deformed to the second. Methods: `shape keys` as in the output, `linear` straight to the
last of these keys, Shrinkwrap with default settings, and the nearest point with a similar normal.

mean, 95 %  distance from the last key to the other surface, relative to its diagonal
uncovered   distance from the other surface to the last key, 95 %: parts that are not reached
normals     mean angle between their normals, degrees
crossing    fraction of triangles that cross others, beyond that of the shapes: in the last key, and maximum on the way
turned      triangles of the last key facing away from the other surface; collapsed ones lost 99 % of their area
volume      largest error on the way, relative to the mesh's own at both ends; error of the last key's
stretch     median ratio of the singular values of the deformation, which stretches UV maps
"""
_COLUMNS = (
    f"{'':16} {'way':13} {'mean':>7} {'95 %':>7} {'uncovered':>9} {'normals':>7} {'crossing':>8} {'way':>7} "
    f"{'turned':>6} {'collapsed':>9} {'volume':>7} {'end':>7} {'stretch':>7} {'keys':>4} {'CPU s':>6}"
)
_GOALS = (
    f"{'to reach':16} {'':13} {'0.10 %':>7} {'0.40 %':>7} {'':>9} {'5.0':>7} {'0.50 %':>8} {'':>7} {'0':>6} {'0':>9} "
    f"{'1.0 %':>7} {'':>7} {'1.15':>7} {'6':>4} {'10':>6}"
)


def main(pairs: Sequence[str] | None, error: float, *, as_json: bool = False, keep: Path | None = None) -> None:
    """Make shape keys for pairs and print the table.

    Parameters
    ----------
    pairs : sequence of str or None
        Names of pairs of the benchmark `coherence`; by default `PAIRS`.
    error : float
        Largest distance of vertices from their path between keys, in percent of the diagonal.
    as_json : bool
        Print one line of JSON per pair instead.
    keep : Path or None
        A folder to write the keys to.
    """
    if not as_json:
        print(_HEADING)
        print(_COLUMNS)
    for pair in PAIRS if pairs is None else pairs:
        file = None if keep is None else str((keep / f"{pair.replace(' ', '_')}.npz").absolute())
        found = measured("benchmarks.mesh_cases", "keys", pair=pair, error=error / 100.0, keep=file)
        if as_json:
            print(json.dumps({"pair": pair, **found}), flush=True)
        elif "error" in found:
            print(f"{pair:16} {found['error']}", flush=True)
        else:
            for way, figures in found["ways"].items():
                print(line(pair, way, figures), flush=True)
    if not as_json:
        print(_GOALS)


def line(pair: str, way: str, found: dict[str, float]) -> str:
    """Return a row of the table."""
    figures = MeshFigures(**{name: value for name, value in found.items() if name not in ("cpu", "wall")})
    return (
        f"{pair:16} {way:13} {_percent(figures.distance):>7} {_percent(figures.distance_95):>7} "
        f"{_percent(figures.uncovered):>9} {figures.normals:7.1f} "
        f"{_percent(figures.crossing):>8} {_percent(figures.crossing_way):>7} {figures.turned:6} {figures.collapsed:9} "
        f"{100 * figures.volume:5.1f} % {100 * figures.volume_end:5.1f} % {figures.stretch:7.2f} {figures.keys:4} "
        f"{found['cpu']:6.1f}"
    )


def _percent(share: float) -> str:
    return f"{100 * share:.2f} %"
