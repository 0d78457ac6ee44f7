# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""One shape of a warp: where its vertices are for any weights of the shapes that it is warped to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation
from scipy.sparse import csr_array

from ...geometry.solid_blend import SolidBlend, SolidNodes
from ...geometry.step_flow import StepFlow
from ...progress import Control

# What a cell beside the solid counts against a full one: enough to carry the surface with it.
_LEAST_MASS = 0.02
# From so much on a cell is part of the solid when figures are taken.
_SOLID = 0.5


@dataclass(frozen=True)
class Course:
    """Where a warp takes the nodes of one shape on the way to another, in cells.

    Attributes
    ----------
    meeting : (m, 3) float64
        Where the two shapes meet.
    end : (m, 3) float64
        Laid over the other shape.
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
        Filled shares of the cells.
    """

    def __init__(self, points: NDArray[np.float64], mass: NDArray[np.floating]) -> None:
        self.points = points
        self.nodes = _nodes(points, mass)
        self._interpolation: csr_array = self.nodes.interpolation(points)
        self._courses: dict[int, Course] = {}
        self._blend: SolidBlend | None = None

    def course(self, own: StepFlow, other: StepFlow, control: Control) -> Course:
        """Follow the shape's own flow to the meeting place, and that of the other shape back from there."""
        met = own.moved(self.nodes.positions, control)
        return Course(met, other.moved_back(met, control))

    def take(self, courses: Mapping[int, Course]) -> None:
        """Take the courses to other shapes, by their numbers."""
        self._courses = dict(courses)
        self._blend = SolidBlend(self.nodes, [course.end for course in courses.values()])
        # From half of the way along the blend to the meeting place.
        halves = np.eye(len(self._courses)) / 2.0
        self._detours = [
            course.meeting - self._blend.at(list(half)) for course, half in zip(courses.values(), halves, strict=True)
        ]

    @property
    def partners(self) -> tuple[int, ...]:
        """Numbers of the shapes that there are courses to."""
        return tuple(self._courses)

    def gradients(self, other: int) -> NDArray[np.float64]:
        """Return the gradients of the course to another shape, (c, 3, 3), in the cells of the solid."""
        return self._blend.gradients[self.partners.index(other)][self.nodes.mass > _SOLID]

    def at(self, weights: Sequence[float], own: int, pace: float, detour: float) -> NDArray[np.float64]:
        """Return the vertices, (n, 3) in cells, where all shapes have these weights.

        Parameters
        ----------
        weights : sequence of float
            Of all shapes; they sum to one, and only this shape and its partners have any.
        own : int
            Number of this shape.
        pace : float
            Share of the motion that is done at all.
        detour : float
            How far the way leads through the places where shapes meet, from 0 to 1.
        """
        shares = [weights[other] for other in self._courses]
        nodes = self._blend.at([pace * share for share in shares])
        for share, way in zip(shares, self._detours, strict=True):
            both = weights[own] + share
            if share > 0:
                nodes += pace * detour * both * np.sin(np.pi * share / both) ** 2 * way
        return self.points + self._interpolation @ (nodes - self.nodes.positions)


def _nodes(points: NDArray[np.float64], mass: NDArray[np.floating]) -> SolidNodes:
    """Corners of all cells that hold some of the solid, that lie beside it, or that have vertices in them."""
    needed = binary_dilation(mass > _LEAST_MASS)
    cells = np.clip(np.floor(points).astype(np.int64), 0, np.array(mass.shape) - 1)
    needed[tuple(cells.T)] = True
    return SolidNodes(np.where(needed, np.maximum(mass, _LEAST_MASS), 0.0))
