# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""One shape of a warp: its vertices for any weights of the shapes that it is warped to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation
from scipy.sparse import csr_array

from ...geometry.deformation.solid_blend import SolidBlend, SolidNodes
from ...geometry.grids.step_flow import StepFlow
from ...progress import Control

# Mass of an empty cell next to the solid, relative to a full one: enough to carry the surface.
_LEAST_MASS = 0.02


@dataclass(frozen=True)
class Course:
    """The nodes of one shape warped to another, in cells.

    Attributes
    ----------
    meeting : (m, 3) float64
        Positions where the two shapes meet.
    end : (m, 3) float64
        Positions on the other shape.
    """

    meeting: NDArray[np.float64]
    end: NDArray[np.float64]


class WarpedShape:
    """A shape in cells of the warp's grid, and its courses to the others.

    Parameters
    ----------
    points : (n, 3) float64
        Its vertices.
    mass : (nx, ny, nz)
        Filled fractions of the cells.
    """

    def __init__(self, points: NDArray[np.float64], mass: NDArray[np.floating]) -> None:
        self.points = points
        self.nodes = _nodes(points, mass)
        self._interpolation: csr_array = self.nodes.interpolation(points)
        self._courses: dict[int, Course] = {}
        self._blend: SolidBlend | None = None

    def course(self, own: StepFlow, other: StepFlow, control: Control) -> Course:
        """Follow the shape's own flow to the meeting position, and the other shape's flow back from there."""
        met = own.moved(self.nodes.positions, control)
        return Course(met, other.moved_back(met, control))

    def take(self, courses: Mapping[int, Course]) -> None:
        """Set the courses to other shapes, by their indices."""
        self._courses = dict(courses)
        self._blend = SolidBlend(self.nodes, [course.end for course in courses.values()])
        # The offset of the meeting position from the middle of the blend.
        halves = np.eye(len(self._courses)) / 2.0
        self._detours = [
            course.meeting - self._blend.at(list(half)) for course, half in zip(courses.values(), halves, strict=True)
        ]

    def at(self, weights: Sequence[float], own: int, pace: float, detour: float) -> NDArray[np.float64]:
        """Return the vertices, (n, 3) in cells, in the blend with some weights.

        Parameters
        ----------
        weights : sequence of float
            Weights of all shapes, of sum one; only this shape and those it is warped to may have positive ones.
        own : int
            Index of this shape.
        pace : float
            Fraction of the motion that is applied.
        detour : float
            How closely the path approaches the positions where shapes meet, from 0 to 1.
        """
        shares = [weights[other] for other in self._courses]
        nodes = self._blend.at([pace * share for share in shares])
        for share, way in zip(shares, self._detours, strict=True):
            both = weights[own] + share
            if share > 0:
                nodes += pace * detour * both * np.sin(np.pi * share / both) ** 2 * way
        return self.points + self._interpolation @ (nodes - self.nodes.positions)


def _nodes(points: NDArray[np.float64], mass: NDArray[np.floating]) -> SolidNodes:
    """Return the corners of all cells that contain the solid, that are next to it, or that contain vertices."""
    needed = binary_dilation(mass > _LEAST_MASS)
    cells = np.clip(np.floor(points).astype(np.int64), 0, np.array(mass.shape) - 1)
    needed[tuple(cells.T)] = True
    return SolidNodes(np.where(needed, np.maximum(mass, _LEAST_MASS), 0.0))
