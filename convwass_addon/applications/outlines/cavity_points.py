# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Points on the surface of a cavity that fills up, while the section around it moves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.algebra.quotients import quotients
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.meshes.outline_finder import OutlineFinder
from ...geometry.recognition.section_cavities import SectionCavity
from .profile_points import ProfilePoints

OPEN = 0.5
"""Where a solid is narrow, at least this share of its radius stays hollow, so that no bubble is enclosed."""


@dataclass(frozen=True)
class CavityPoints:
    """Points on the surface of a cavity, in a section that is filled to the rim.

    Attributes
    ----------
    places : ProfilePoints
        The points.
    lids : ProfilePoints
        Where they are once the cavity is full.
    walls : (n,) float64
        How thick the wall is there.
    thickness : float
        How thick it is typically.
    side : float
        The side that the cavity is open to; see :class:`...geometry.section_cavities.SectionCavity`.
    """

    places: ProfilePoints
    lids: ProfilePoints
    walls: NDArray[np.float64]
    thickness: float
    side: float

    @classmethod
    def of(
        cls, points: NDArray[np.float64], cavity: SectionCavity, section: TriangleMesh, thickness: float
    ) -> CavityPoints:
        """Attach points of a cavity, (n, 2), to the triangles of the filled section.

        Parameters
        ----------
        points, cavity, section
            The points, their cavity, and the triangles.
        thickness : float
            How thick the wall is typically. Nowhere does it count as thicker: the bottom is no wall.
        """
        lids = np.column_stack([np.minimum(points[:, 0], cavity.rim[0]), np.full(len(points), cavity.rim[1])])
        walls = OutlineFinder(cavity.outside.part(~cavity.at_top(cavity.outside))).distances(points)
        places = (ProfilePoints.of(each, section) for each in (points, lids))
        return cls(*places, np.minimum(walls, thickness), thickness, cavity.side)

    def moved(self, section: TriangleMesh, outside: OutlineFinder) -> MovedCavity:
        """Return the points for a moved section, whose outline on one side of the axis is given, without its top."""
        places, lids = self.places.on(section), self.lids.on(section)
        return MovedCavity(places, lids, self.walls, self.thickness, self.side, outside)


@dataclass(frozen=True)
class MovedCavity:
    """Points on the surface of a cavity of a moved section.

    Attributes
    ----------
    points, lids : (n, 2) float64
        The points, and where they are once the cavity is full.
    walls, thickness, side
        As for :class:`CavityPoints`.
    outside : OutlineFinder
        The outline on one side of the axis, without the top.
    """

    points: NDArray[np.float64]
    lids: NDArray[np.float64]
    walls: NDArray[np.float64]
    thickness: float
    side: float
    outside: OutlineFinder

    @property
    def depths(self) -> NDArray[np.float64]:
        """How far the points are below the lid, (n,)."""
        return self.side * (self.lids[:, 1] - self.points[:, 1])

    def at(self, depth: float) -> NDArray[np.float64]:
        """Return the points, (n, 2), on the surface of a cavity that is filled up to a depth below its lid.

        Below the rim, walls do not become thinner than they are at rest: where the solid is narrow, so is the cavity.
        """
        level = self.lids - (0.0, self.side * depth)
        # The surface reaches to the wall, which may be farther away than the rim.
        reached = np.minimum(self.points[:, 0], np.maximum(level[:, 0], self._room(level) - self.walls))
        is_filled = self.depths > depth
        found = np.where(is_filled[:, None], np.column_stack([reached, level[:, 1]]), self.points)
        shares = (self.side * (self.lids[:, 1] - found[:, 1]) / self.thickness).clip(0.0, 1.0)
        return found + shares[:, None] * (self._within_walls(found) - found)

    def _within_walls(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return points, (n, 2), at least as far from the outside as the wall is thick, if there is room."""
        nearest = self.outside.nearest(points)
        away = points - nearest
        distances = np.linalg.norm(away, axis=1)
        factors = quotients(self.walls, distances, 1.0)
        found = nearest + np.maximum(factors, 1.0)[:, None] * away
        found[:, 0] = np.maximum(found[:, 0], np.minimum(points[:, 0], OPEN * self._room(points)))
        return found

    def _room(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return how far the outside is from the axis beyond points inside, (n,); zero above it."""
        (first, low), (last, high) = self.outside.outline.starts.T, self.outside.outline.ends.T
        rows, edges = np.nonzero((low <= points[:, 1, None]) != (high <= points[:, 1, None]))
        shares = (points[rows, 1] - low[edges]) / (high[edges] - low[edges])
        away = first[edges] + shares * (last[edges] - first[edges])
        beyond = away >= points[rows, 0]
        found = np.full(len(points), np.inf)
        np.minimum.at(found, rows[beyond], away[beyond])
        return np.where(np.isfinite(found), found, 0.0)
