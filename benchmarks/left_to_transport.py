# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How much of the transport a motion leaves: distance between the moved shapes relative to that of the shapes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import numpy as np

from convwass_addon.applications.morphs.moving_problem import MovingProblem
from convwass_addon.applications.motions.motion import Motion
from convwass_addon.geometry.centroid import centroid
from convwass_addon.geometry.mesh import TriangleMesh
from convwass_addon.geometry.occupancy import occupancy
from convwass_addon.transport import Grid, distance

TIMES = (0.25, 0.5, 0.75)
_CELLS = 48
_MARGIN = 4.0
_TOLERANCE, _MOST_ROUNDS = 1e-2, 200


def left_to_transport(motion: Motion, shapes: Sequence[TriangleMesh]) -> float:
    """Return the largest W2 between two moved shapes over the W2 of the shapes themselves, centers of mass aligned.

    Parameters
    ----------
    motion : Motion
        The motion of the two shapes.
    shapes : sequence of TriangleMesh
        The two.
    """
    apart = _distance([shape.moved(-centroid(shape)) for shape in shapes])
    left = [_distance([shape.mesh for shape in motion.moved((1.0 - t, t))]) for t in TIMES]
    return max(left) / apart


def _distance(meshes: Sequence[TriangleMesh]) -> float:
    """Return W2 between two solids of mass 1, in the unit of the meshes."""
    low = np.min([mesh.bounds[0] for mesh in meshes], axis=0)
    high = np.max([mesh.bounds[1] for mesh in meshes], axis=0)
    spacing = float((high - low).max()) / _CELLS
    cells = tuple(np.ceil((high - low) / spacing + 2.0 * _MARGIN).astype(int))
    solids = [occupancy((mesh.corners - low) / spacing + _MARGIN, cells) for mesh in meshes]
    found = distance(*solids, Grid(cells, sigma=1.0), tolerance=_TOLERANCE, max_iterations=_MOST_ROUNDS)
    return found.length * spacing


@contextmanager
def recorded_motions() -> Iterator[list[Motion]]:
    """Record the motions of all morphs made in the body."""
    recorded: list[Motion] = []
    original = MovingProblem.__dict__["of"]

    def recording(_kind: type, still: object, motion: Motion, *rest: object, **named: object) -> MovingProblem:
        recorded.append(motion)
        return original.__func__(MovingProblem, still, motion, *rest, **named)

    MovingProblem.of = classmethod(recording)
    try:
        yield recorded
    finally:
        MovingProblem.of = original
