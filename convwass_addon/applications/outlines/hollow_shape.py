# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Solids of revolution with a cavity, which fills up."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.meshes.outline_finder import OutlineFinder
from ...geometry.plane.planar_fill import Boundary
from ...geometry.recognition.revolution import Revolution
from ...geometry.recognition.section_cavities import SectionCavity, revolved_volume
from ..motions.motion import MovedShape
from .cavity_points import CavityPoints, MovedCavity
from .revolved_shape import RevolvedShape

# Points of the profile of a cavity are at most this share of its size apart.
_SPACING = 0.01
# The bottom of a cavity moves at most so many times as fast as evenly: the neck of a bottle would fill within a frame.
_FASTEST = 1.5
# Accuracy of depths, relative to the largest one.
_DEPTH = 1e-5
# Vertices closer to the outside than to the cavity, up to this share of the size, are not on its surface.
_CLOSER = 1e-6


@dataclass(frozen=True)
class HollowShape:
    """A solid with a cavity that moves as its section, filled to the rim, does.

    Attributes
    ----------
    shape : RevolvedShape
        The solid, attached to the filled section.
    in_cavity : (n,) bool
        Which vertices are on the surface of the cavity.
    vertices : CavityPoints
        These vertices.
    profile : CavityPoints
        Points from the rim to the axis, by which the volume of the cavity is measured.
    is_top : (e,) bool
        Which edges of the outline of the filled section are at its rim, or on its lid.
    """

    shape: RevolvedShape
    in_cavity: NDArray[np.bool_]
    vertices: CavityPoints
    profile: CavityPoints
    is_top: NDArray[np.bool_]

    @classmethod
    def of(
        cls,
        shape: RevolvedShape,
        found: Revolution,
        frame: NDArray[np.float64],
        section: TriangleMesh,
        outline: Boundary,
        cavity: SectionCavity,
    ) -> HollowShape:
        """Find the cavity of a solid that is attached to the triangles of its filled section, which has an outline."""
        profile = found.profile_of((shape.divided.mesh.vertices - found.center) @ frame.T)
        size = np.ptp(found.section.bounds, axis=0).max()
        outside = OutlineFinder(cavity.outside)
        in_cavity = OutlineFinder(cavity.surface).distances(profile) < outside.distances(profile) - _CLOSER * size
        corners = cavity.profile
        fine = Boundary(corners[:-1], corners[1:]).divided(_SPACING * size)
        points = np.concatenate([fine.starts, fine.ends[-1:]])
        # Half of the wall is thicker.
        thickness = float(np.median(outside.distances(points)))
        own = np.maximum(profile[in_cavity], (0.0, -np.inf))
        both = (CavityPoints.of(each, cavity, section, thickness) for each in (own, points))
        return cls(shape, in_cavity, *both, cavity.at_top(outline))

    @property
    def is_loose(self) -> NDArray[np.bool_]:
        """Which vertices are on attached parts, or on the surface of the cavity, (n,)."""
        return self.shape.is_loose | self.in_cavity

    def moved(
        self, section: TriangleMesh, outline: Boundary, place: NDArray[np.float64], left: float, hollow: float
    ) -> MovedShape:
        """Return the solid for its moved section, with a cavity that is filled up to a level.

        Parameters
        ----------
        section, place, left
            As for :meth:`.RevolvedShape.moved`.
        outline : Boundary
            The outline of the moved section.
        hollow : float
            The share of the filled solid that the cavity has, if there is room for it, and unless its bottom would move
            too fast.
        """
        is_right = (outline.starts[:, 0] > 0.0) & (outline.ends[:, 0] > 0.0)
        outside = OutlineFinder(outline.part(is_right & ~self.is_top))
        profile = self.profile.moved(section, outside)
        most = _FASTEST * left * float(profile.depths.max())
        depth = min(_depth(profile, hollow * revolved_volume(outline)), most)
        points = self.shape.places.on(section)
        points[self.in_cavity] = self.vertices.moved(section, outside).at(depth)
        return self.shape.beside(points, place, left)


def _depth(profile: MovedCavity, wanted: float) -> float:
    """Return the depth up to which a cavity must be filled to have a volume; the largest one if it has less."""
    closed, deepest = _integral(profile.lids), float(profile.depths.max())

    def missing(depth: float) -> float:
        return profile.side * (closed - _integral(profile.at(depth))) - wanted

    if missing(deepest) <= 0.0:
        return deepest
    return float(brentq(missing, 0.0, deepest, xtol=_DEPTH * deepest)) if missing(0.0) < 0.0 else 0.0


def _integral(profile: NDArray[np.float64]) -> float:
    """Return the integral of pi r^2 dy along points on one side of the axis, (n, 2)."""
    return 2.0 * revolved_volume(Boundary(profile[:-1], profile[1:]))
