# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Guided motions of solids of revolution: they move as the outlines of their sections through the axis do."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry.closest_points import ClosestPointFinder
from ...geometry.mean_stretches import area_preserving_mean
from ...geometry.mesh import TriangleMesh
from ...geometry.planar_fill import Boundary
from ...geometry.revolution import Revolution, common_revolutions
from ...geometry.ring_nesting import outline_of
from ...geometry.subdivision import Subdivision, bendable
from ...progress import Control
from ..motions.guided_settings import GuidedSettings
from ..motions.motion import MovedShape, weights_between
from ..motions.motion_choice import MotionChoice
from ..motions.motion_request import MotionRequest
from .even_volume import EvenVolumeMotion
from .matched_outlines import MatchedOutlines, placed_outlines
from .outline_curves import OutlineCurve
from .outline_motion import outline_motion
from .section_motion import SectionMotion
from .sheets import AttachedPoints

# A section is symmetric all along the way if both sides differ at most by this share of its longest side.
_SYMMETRIC = 0.05
# Largest share of the area of a section that may overlap itself on the way.
_MOST_OVERLAP = 0.03
# Least and largest distance of a chord from the axis, relative to that of its ends; for six sides, it is 0.87.
_SAG = 0.8, 1.0
# The mirror image of a section about the axis.
_MIRROR = (-1.0, 1.0)


@dataclass(frozen=True)
class RevolvedShape:
    """A solid of revolution, whose vertices follow both sides of its section.

    Attributes
    ----------
    divided : Subdivision
        The shape in scene space, with long edges divided.
    sides : AttachedPoints
        The places on the outline of the section nearest to its vertices, and then their mirror images.
    shares : (n,) float64
        Distances of the vertices from the axis, relative to those of these places. Edges around the axis are chords,
        whose sag would grow where a thin wall becomes thick.
    offsets : (n, 2) float64
        The rest of their differences from these places: away from the axis, and along it.
    directions : (n, 3) float64
        Unit vectors from the axis to the vertices.
    axis : (3,) float64
        Direction of the axis.
    """

    divided: Subdivision
    sides: AttachedPoints
    shares: NDArray[np.float64]
    offsets: NDArray[np.float64]
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
        profile = np.column_stack([found.across.radii(points), points[:, 1]])
        places = _on_outline(found.section, profile)
        both = np.concatenate([places, places * _MIRROR])
        sides = AttachedPoints.of(both, section, ClosestPointFinder(section.corners))
        shares = np.divide(radii, places[:, 0], out=np.ones_like(radii), where=places[:, 0] > 0.0).clip(*_SAG)
        offsets = np.column_stack([radii, points[:, 1]]) - places * np.column_stack([shares, np.ones_like(shares)])
        return cls(divided, sides, shares, offsets, (away * (1.0, 0.0, 1.0)) @ frame, frame[1])

    def moved(self, section: TriangleMesh, place: NDArray[np.float64]) -> MovedShape:
        """Return the shape for its moved section, about a point; see :class:`.section_motion.SectionShape`."""
        right, mirrored = self._sides(section)
        away, along = 0.5 * (right + mirrored).T
        away, along = (self.shares * away + self.offsets[:, 0])[:, None], (along + self.offsets[:, 1])[:, None]
        vertices = place + away * self.directions + along * self.axis
        return MovedShape(self.divided.mesh, vertices, self.divided.parents)

    def asymmetry(self, moved: TriangleMesh) -> float:
        """Return the largest distance between a point of a moved section and the mirror image of its counterpart."""
        right, mirrored = self._sides(moved)
        return float(np.linalg.norm(right - mirrored, axis=1).max())

    def _sides(self, moved: TriangleMesh) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        right, left = np.split(self.sides.on(moved), 2)
        return right, left * _MIRROR


def revolved_motion(request: MotionRequest, control: Control) -> MotionChoice | None:
    """Return the guided motion of solids of revolution about parallel axes.

    Returns
    -------
    MotionChoice or None
        None if a shape is not revolved, or if sections have different numbers of regions or holes, do not stay
        symmetric, or overlap themselves.
    """
    found = common_revolutions(request.shapes)
    if found is None:
        return None
    frame, revolutions = found
    sections = [own.section for own in revolutions]
    if len({tuple(len(region.holes) for region in outline_of(own).regions) for own in sections}) > 1:
        return None
    # With the arithmetic mean of stretches, thin walls would become thick on the way.
    settings = GuidedSettings(coherence=request.coherence, mean_stretch=area_preserving_mean)
    moved = outline_motion(sections, request.names, request.pairs, settings, control, _upright)
    if moved is None or moved.overlap > _MOST_OVERLAP:
        return None
    flat = moved.choice.motion
    shapes = tuple(
        RevolvedShape.of(mesh, own, frame, carrier.rest)
        for mesh, own, carrier in zip(request.shapes, revolutions, flat.guided.carriers, strict=True)
    )
    for pair in request.pairs:
        halfway = flat.moved(weights_between(len(shapes), pair, 0.5))
        for index in pair:
            if shapes[index].asymmetry(halfway[index].mesh) > _SYMMETRIC * np.ptp(sections[index].bounds, axis=0).max():
                return None
    centers = np.stack([own.center for own in revolutions])
    volumes = np.array([mesh.volume for mesh in request.shapes])
    motion = EvenVolumeMotion(SectionMotion(flat, shapes, centers), volumes, centers, flat.guided.settings.way)
    return replace(moved.choice, motion=motion)


def _on_outline(section: Boundary, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the points of an outline nearest to others, (n, 2), on the side of the axis that these are on."""
    edges = np.pad(np.stack([section.starts, section.ends, section.ends], axis=1), ((0, 0), (0, 0), (0, 1)))
    found = ClosestPointFinder(edges).find(np.pad(points, ((0, 0), (0, 1))))
    return np.maximum(found.interpolated(edges)[:, :2], (0.0, -np.inf))


def _upright(one: OutlineCurve, other: OutlineCurve) -> list[MatchedOutlines]:
    """Match two sections about their axes, neither turned upside down nor with limbs that swing to one side."""
    return [placed_outlines(one, other)]
