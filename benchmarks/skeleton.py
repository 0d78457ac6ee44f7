# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How well skeletons fit if only their tips are pinned, compared with placements that ignore the body."""

from __future__ import annotations

from pathlib import Path

from .processes import PROJECT, measured

_CASES = "benchmarks.skeleton_cases"
_SHAPES = PROJECT / "assets" / "shapes"
_OWN = ("horse", "bird", "octopus", "dolphins", "double_torus")
_OTHERS = ("spot", "blub", "bob")

_TITLE = """
Skeletons with pins at their tips (and at three joints of every loop), compared with joints placed by hand. The bones
have their lengths by hand, times a random 0.6 to 1.4 (loops close as a result); for "even", all equal. CPU seconds.

in        percentage of the free joints inside the body
error     mean distance to the joints placed by hand, in % of the diagonal of the body
          fit        the extension's method: placed by propagation, then settled along the centers of the limbs
          even       the same with equal bones
          means      placed only, at the means of the joints' distributions, as in the paper
          harmonic   weighted means of the neighbors in space, not settled; and settled like the fit
          straight   evenly along straight lines between pins, branching joints at the mean of the pins
"""
_LARGE = """
The bumpy shape with {vertices} vertices, a star of {joints} joints: {seconds:.1f} s, {inside:.0f} % inside.
"""
_WAYS = ("fit", "even", "means", "harmonic", "settled", "straight")


def main(meshes: Path | None) -> None:
    """Run all cases and print the table.

    Parameters
    ----------
    meshes : Path or None
        A folder with additional meshes; uses spot, blub and bob if they exist.
    """
    print(_TITLE)
    print(f"{'':12} {'joints':>6} {'pins':>4} {'s':>5}  " + "".join(f"{way + ' in, error':>21}" for way in _WAYS))
    for name in (*_OWN, *_OTHERS):
        path = _SHAPES / f"{name}.ply" if name in _OWN else _mesh_file(meshes, name)
        if path is None:
            continue
        found = measured(_CASES, "fit", path=str(path), name=name)
        row = "".join(f"{found[way]['inside']:14.0f} {found[way]['error']:6.1f}" for way in _WAYS)
        print(f"{name:12} {found['joints']:6} {found['pins']:4} {found['seconds']:5.1f}  {row}", flush=True)
    print(_LARGE.format(**measured(_CASES, "large", vertices=5000, joints=60)))


def _mesh_file(folder: Path | None, name: str) -> Path | None:
    """Return the triangle mesh whose file name begins with a name; None if there is none."""
    if folder is None:
        return None
    return next((path for path in sorted(folder.glob(f"{name}_tri*.obj"))), None)
