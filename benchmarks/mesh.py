# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""One mesh with shape keys to another shape, beside what Blender offers for it."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from .mesh_measures import MeshFigures
from .processes import measured

PAIRS = ("man walks", "man raises arm", "dog rears", "horse to cow", "hand points", "man to ogre")
"""Pairs of one build that may be looked at while parameters are chosen."""

_HEADING = """
The mesh of the first shape, which takes the second. Ways: `shape keys` as the output makes them, `linear` straight to
the last of these keys, Shrinkwrap with its default settings, and the nearest point that faces the same way.

mean, 95 %  distance of the last key to the other surface, of its diagonal
normals     mean angle between both there, degrees
crossing    triangles that cross another one beyond those of the shapes: in the last key, and the most on the way
turned      triangles that face away from the other surface in the last key; collapsed ones lost 99 % of their area
volume      largest error on the way
stretch     median ratio of the singular values of the deformation, which stretches UV maps
"""
_COLUMNS = (
    f"{'':16} {'way':13} {'mean':>7} {'95 %':>7} {'normals':>7} {'crossing':>8} {'way':>7} {'turned':>6} "
    f"{'collapsed':>9} {'volume':>7} {'stretch':>7} {'keys':>4} {'CPU s':>6}"
)
_GOALS = (
    f"{'to reach':16} {'':13} {'0.10 %':>7} {'0.40 %':>7} {'5.0':>7} {'0.50 %':>8} {'':>7} {'0':>6} {'0':>9} "
    f"{'1.0 %':>7} {'1.15':>7} {'6':>4} {'10':>6}"
)


def main(pairs: Sequence[str] | None, error: float, *, as_json: bool = False, keep: Path | None = None) -> None:
    """Make shape keys of pairs and print the table.

    Parameters
    ----------
    pairs : sequence of str or None
        Names of pairs of the benchmark `coherence`; `PAIRS` by default.
    error : float
        How far vertices may leave their path between keys, in percent of the diagonal.
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
        f"{pair:16} {way:13} {_percent(figures.distance):>7} {_percent(figures.distance_95):>7} {figures.normals:7.1f} "
        f"{_percent(figures.crossing):>8} {_percent(figures.crossing_way):>7} {figures.turned:6} {figures.collapsed:9} "
        f"{100 * figures.volume:5.1f} % {figures.stretch:7.2f} {figures.keys:4} {found['cpu']:6.1f}"
    )


def _percent(share: float) -> str:
    return f"{100 * share:.2f} %"
