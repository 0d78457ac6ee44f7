# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Guided motions of solids of revolution: they move as the outlines of their sections through the axis do."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry.closest_points import ClosestPointFinder
from ...geometry.mesh import TriangleMesh
from ...geometry.revolution import Revolution, common_revolutions
from ...geometry.ring_nesting import outline_of
from ...geometry.subdivision import Subdivision, bendable
from ...progress import Control
from ..motions.motion import MovedShape
from ..motions.motion_choice import MotionChoice
from ..motions.motion_request import MotionRequest
from .section_motion import SectionMotion, moved_sections
from .sheets import AttachedPoints

# A section is symmetric all along the way if both sides differ at most by this share of the square root of its area.
_SYMMETRIC = 0.05


@dataclass(frozen=True)
class RevolvedShape:
    """A solid of revolution, whose vertices follow both sides of its section.

    Attributes
    ----------
    divided : Subdivision
        The shape in scene space, with long edges divided.
    right, left : AttachedPoints
        The places of its vertices in the section, and their mirror images.
    directions : (n, 3) float64
        Unit vectors from the axis to the vertices.
    axis : (3,) float64
        Direction of the axis.
    """

    divided: Subdivision
    right: AttachedPoints
    left: AttachedPoints
    directions: NDArray[np.float64]
    axis: NDArray[np.float64]

    @classmethod
    def of(
        cls, mesh: TriangleMesh, found: Revolution, frame: NDArray[np.float64], section: TriangleMesh
    ) -> RevolvedShape:
        """Attach an input to the triangles of its section."""
        divided = bendable(mesh)
        points = (divided.mesh.vertices - found.center) @ frame.T
        radii = np.hypot(points[:, 0], points[:, 2])
        away = np.divide(points, radii[:, None], out=np.zeros_like(points), where=radii[:, None] > 0.0)
        finder = ClosestPointFinder(section.corners)
        right, left = (
            AttachedPoints.of(np.column_stack([side * radii, points[:, 1]]), section.vertices, section.faces, finder)
            for side in (1.0, -1.0)
        )
        return cls(divided, right, left, (away * (1.0, 0.0, 1.0)) @ frame, frame[1])

    def moved(self, section: TriangleMesh, place: NDArray[np.float64]) -> MovedShape:
        """Return the shape for its moved section, about a point; see :class:`.section_motion.SectionShape`."""
        right, mirrored = self._sides(section)
        away, along = (0.5 * (right + mirrored)).T[..., None]
        vertices = place + away * self.directions + along * self.axis
        return MovedShape(self.divided.mesh, vertices, self.divided.parents)

    def asymmetry(self, moved: TriangleMesh) -> float:
        """Return the largest distance between a point of a moved section and the mirror image of its counterpart."""
        right, mirrored = self._sides(moved)
        return float(np.linalg.norm(right - mirrored, axis=1).max())

    def _sides(self, moved: TriangleMesh) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        right, left = (own.on(moved.vertices, moved.faces) for own in (self.right, self.left))
        return right, left * (-1.0, 1.0)


def revolved_motion(request: MotionRequest, control: Control) -> MotionChoice | None:
    """Return the guided motion of solids of revolution about parallel axes.

    Returns
    -------
    MotionChoice or None
        None if a shape is not revolved, if sections have different numbers of regions or holes, would be distorted too
        much, or are turned.
    """
    found = common_revolutions(request.shapes)
    if found is None:
        return None
    frame, revolutions = found
    sections = [own.section for own in revolutions]
    if len({tuple(len(region.holes) for region in outline_of(own).regions) for own in sections}) > 1:
        return None
    moved = moved_sections(request, sections, control)
    if moved is None or moved.choice.turned:
        return None
    flat = moved.choice.motion
    shapes = tuple(
        RevolvedShape.of(mesh, own, frame, carrier.rest)
        for mesh, own, carrier in zip(request.shapes, revolutions, flat.guided.carriers, strict=True)
    )
    for pair in request.pairs:
        weights = np.zeros(len(shapes))
        weights[list(pair)] = 0.5
        halfway = flat.moved(weights)
        for index in pair:
            if shapes[index].asymmetry(halfway[index].mesh) > _SYMMETRIC * np.sqrt(sections[index].area):
                return None
    centers = np.stack([own.center for own in revolutions])
    return replace(moved.choice, motion=SectionMotion(flat, shapes, centers))
