# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Solids of revolution whose vertices follow the outlines of their sections, and what is attached to these solids."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.algebra.quotients import quotients
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.meshes.outline_finder import OutlineFinder
from ...geometry.recognition.revolution import Revolution
from ...geometry.remeshing.subdivision import Subdivision, bendable
from ..motions.motion import MovedShape
from .attached_parts import AttachedParts
from .profile_points import ProfilePoints

# Least and largest distance of a chord from the axis, relative to that of its ends; for six sides, it is 0.87.
_SAG = 0.8, 1.0
# Edges may be longer by this factor where they arrive.
_LONGER = 1.5


@dataclass(frozen=True)
class RevolvedShape:
    """A solid of revolution, whose vertices follow both sides of its section.

    Attributes
    ----------
    divided : Subdivision
        The shape in scene space, with long edges divided.
    distances : (n,) float64
        Distances of its vertices from the axis.
    places : ProfilePoints
        The places on the outline of the section nearest to the vertices.
    shares : (n,) float64
        Distances of the vertices from the axis, relative to those of these places. Edges around the axis are chords,
        whose sag would grow where a thin wall becomes thick.
    offsets : (n, 2) float64
        The rest of their differences from these places: away from the axis, and along it.
    attached : AttachedParts
        What is attached to the solid.
    directions : (n, 3) float64
        Unit vectors from the axis to the vertices.
    axis : (3,) float64
        Direction of the axis.
    """

    divided: Subdivision
    distances: NDArray[np.float64]
    places: ProfilePoints
    shares: NDArray[np.float64]
    offsets: NDArray[np.float64]
    attached: AttachedParts
    directions: NDArray[np.float64]
    axis: NDArray[np.float64]

    @classmethod
    def of(
        cls,
        mesh: TriangleMesh,
        found: Revolution,
        frame: NDArray[np.float64],
        section: TriangleMesh,
        arrivals: Sequence[TriangleMesh],
    ) -> RevolvedShape:
        """Attach an input to the triangles of its section.

        Parameters
        ----------
        mesh : TriangleMesh
            The input.
        found : Revolution
            What it is.
        frame : (3, 3)
            A direction across the axis, the axis, and the direction across both, as rows.
        section : TriangleMesh
            The triangles of its section.
        arrivals : sequence of TriangleMesh
            These triangles where they become other sections. Edges that become long there are divided.
        """
        finder = OutlineFinder(found.section)

        def places_of(vertices: NDArray[np.float64]) -> NDArray[np.float64]:
            profile = found.profile_of((vertices - found.center) @ frame.T)
            return np.maximum(finder.nearest(profile), (0.0, -np.inf))

        def image(vertices: NDArray[np.float64]) -> NDArray[np.float64]:
            own = ProfilePoints.of(places_of(vertices), section)
            return np.concatenate([own.on(arrival) for arrival in arrivals], axis=1) / _LONGER

        divided = bendable(mesh, image=image if arrivals else None)
        points = (divided.mesh.vertices - found.center) @ frame.T
        radii = np.hypot(points[:, 0], points[:, 2])
        away = quotients(points, radii[:, None])
        places = places_of(divided.mesh.vertices)
        shares = quotients(radii, places[:, 0], 1.0).clip(*_SAG)
        offsets = np.column_stack([radii, points[:, 1]]) - places * np.column_stack([shares, np.ones_like(shares)])
        directions, axis = (away * (1.0, 0.0, 1.0)) @ frame, frame[1]
        attached = AttachedParts.none(len(points))
        if not found.is_whole:
            attached = AttachedParts.of(divided.mesh, np.linalg.norm(offsets, axis=1), radii, directions, axis)
        return cls(divided, radii, ProfilePoints.of(places, section), shares, offsets, attached, directions, axis)

    @property
    def is_loose(self) -> NDArray[np.bool_]:
        """Which vertices are on attached parts, (n,)."""
        return self.attached.looseness > 0.0

    def moved(self, section: TriangleMesh, place: NDArray[np.float64], left: float) -> MovedShape:
        """Return the shape for its moved section.

        Parameters
        ----------
        section : TriangleMesh
            In the plane z = 0.
        place : (3,)
            The point of the axis that is the origin of the section.
        left : float
            How far the solid is from the others, from 1 at rest to 0.
        """
        return self.beside(self.places.on(section), place, left)

    def beside(self, profile: NDArray[np.float64], place: NDArray[np.float64], left: float) -> MovedShape:
        """Return the shape with vertices beside points of its moved section, (n, 2), otherwise as :meth:`moved`."""
        away, along = profile.T
        offsets = self.attached.retracted(self.offsets, left)
        away, along = self.shares * away + offsets[:, 0], along + offsets[:, 1]
        turns = self.attached.turns(quotients(self.distances, away, 1.0))[:, None]
        directions = np.cos(turns) * self.directions + np.sin(turns) * np.cross(self.axis, self.directions)
        vertices = place + away[:, None] * directions + along[:, None] * self.axis
        return MovedShape(self.divided.mesh, vertices, self.divided.parents)
