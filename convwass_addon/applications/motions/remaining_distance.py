# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How much of the distance between two shapes a motion leaves."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...geometry.arrays.bounds import common_bounds
from ...geometry.meshes.centroid import centroid
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.solids.thicken import solid_or_shell_occupancy
from ...progress import UNINTERRUPTED, Control
from ...transport import Grid, distance
from ..workers import side_by_side
from .motion import Motion, weights_between

TIMES = (0.25, 0.5, 0.75)
"""Where on the way from one shape to the other the distance is measured."""

_MARGIN = 4.0
_TOLERANCE, _MOST_ITERATIONS = 1e-2, 200
# Equal solids are this many cells apart at most, within the tolerance.
_NOTHING = 0.05


def remaining_share(
    motion: Motion,
    shapes: Sequence[TriangleMesh],
    pair: tuple[int, int] = (0, 1),
    cells: int = 48,
    control: Control = UNINTERRUPTED,
) -> float:
    """Return the largest W2 between two moved shapes over the W2 of the shapes themselves, centers of mass aligned.

    Parameters
    ----------
    motion : Motion
        The motion of all shapes.
    shapes : sequence of TriangleMesh
        The shapes at rest.
    pair : (int, int)
        The two shapes that are compared.
    cells : int
        Cells along the longest side of the grid on which solids of mass 1 are compared.
    control : Control
        Stops the work.

    Returns
    -------
    float
        0 for equal shapes.
    """
    rests = [shapes[index] for index in pair]

    def distance_at(number: int) -> float:
        if number == len(TIMES):
            return centered_distance(rests, cells, control)
        moved = motion.moved(weights_between(len(shapes), pair, TIMES[number]))
        return _distance([moved[index].mesh for index in pair], cells, control)

    *between, apart = side_by_side(distance_at, len(TIMES) + 1)
    return max(between) / apart if apart > 0.0 else 0.0


def centered_distance(shapes: Sequence[TriangleMesh], cells: int, control: Control) -> float:
    """Return W2 between two shapes with their centers of mass aligned, in their unit; 0 for equal shapes.

    Parameters
    ----------
    shapes : sequence of TriangleMesh
        The two shapes.
    cells, control
        As for :func:`remaining_share`.
    """
    return _distance([shape.moved(-centroid(shape)) for shape in shapes], cells, control)


def _distance(meshes: Sequence[TriangleMesh], cells: int, control: Control) -> float:
    """Return W2 between two solids of mass 1, in the unit of the meshes."""
    low, high = common_bounds([mesh.bounds for mesh in meshes])
    spacing = float((high - low).max()) / cells
    shape = tuple(np.ceil((high - low) / spacing + 2.0 * _MARGIN).astype(int))
    solids = [solid_or_shell_occupancy((mesh.corners - low) / spacing + _MARGIN, shape) for mesh in meshes]
    grid = Grid(shape, sigma=1.0)
    found = distance(*solids, grid, tolerance=_TOLERANCE, max_iterations=_MOST_ITERATIONS, control=control)
    return found.length * spacing if found.length > _NOTHING else 0.0
