# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The deformation of a shape that matches another, divided into rotations and stretches of its parts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.algebra.rotation_fields import (
    LARGEST_TURN,
    nearest_branches,
    rotation_matrices,
    rotation_vectors,
    unwound,
    unwound_towards,
)
from ...geometry.algebra.rotations import nearest_rotations
from ...geometry.deformation.hinged_poses import HingedPose, hinged_points
from ...geometry.deformation.poisson_deformation import deformation_gradients
from ...geometry.deformation.surface_rotations import surface_rotations
from ...geometry.deformation.swing_twist import (
    divided_turns,
    inverse_turns,
    mean_turns,
    median_rotation,
    turn_matrices,
    turns_with_twists,
)
from ...geometry.meshes.closest_points import ClosestPoints
from ...geometry.meshes.edges import mesh_edges
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.meshes.normals import vertex_normals
from ...progress import Control
from .carriers import Carrier
from .laid_meshes import Laid

# Size of the neighborhoods that rotate together, in sizes of the surface.
_TURN_WIDTH = 0.03
# A body whose parts rotate does not turn itself if its points move by less than this share of what they would without
# the common rotation of the parts: the letters of a word may turn where they are.
_STAYS = 0.5
# If a body turns by about half a circle, rounding does not decide in which sense.
_CLEARLY = 0.95


@dataclass(frozen=True)
class ShapeDeformation:
    """The deformation of a shape that matches another.

    The gradient of triangle t is R_t Q_t, where R_t is the rotation of the mean turn of its corners.

    Attributes
    ----------
    points : (n, 3) float64
        Deformed vertices of the carrier, scene units.
    turns : (n, 3, 3) float64
        Rotations of its vertices, continuous along the surface; see :mod:`.swing_twist`.
    stretches : (m, 3, 3) float64
        Q of every triangle.
    link_stretches : (k, 3) float64
        The deformed links, rotated back.
    pose : HingedPose
        Rigid motions of its parts.
    offsets : (n, 3) float64
        Differences of the vertices from the positions that the parts give them, rotated back.
    scale : float
        Scale factor of the whole shape.
    images : ClosestPoints
        The points of the other carrier on which the deformed vertices lie.
    confidence : (n,) float64
        Confidence in these points, 0 to 1, from the round-trip error.
    """

    points: NDArray[np.float64]
    turns: NDArray[np.float64]
    stretches: NDArray[np.float64]
    link_stretches: NDArray[np.float64]
    pose: HingedPose
    offsets: NDArray[np.float64]
    scale: float
    images: ClosestPoints
    confidence: NDArray[np.float64]

    def inverse_turns_at(self, images: ClosestPoints, mesh: TriangleMesh) -> NDArray[np.float64]:
        """Return the turns of the inverse deformation, (k, 3, 3), at points of the carrier's mesh."""
        corners = self.turns.reshape(-1, 9)[mesh.faces]
        return inverse_turns(images.interpolated(corners).reshape(-1, 3, 3))


def split_deformation(
    source: Carrier,
    target: Carrier,
    laid: Laid,
    back: ShapeDeformation | None,
    control: Control,
    images: ClosestPoints | None = None,
    largest_turn: float = LARGEST_TURN,
) -> ShapeDeformation:
    """Divide a deformation into rotations and stretches.

    Parameters
    ----------
    source, target : Carrier
        The deformed shape, and the one that it matches.
    laid : Laid
        The deformed vertices of the source's mesh.
    back : ShapeDeformation, optional
        The deformation of the target that matches the source, if known: parts that could rotate in either sense then
        rotate consistently.
    control : Control
        Stops the work.
    images : ClosestPoints, optional
        The points of the target's mesh on which the deformed vertices lie. Otherwise, close ones that face the same
        way are found.
    largest_turn : float
        Parts that would rotate by more than this angle, in radians, take the short way instead.
    """
    control.check()
    if images is None:
        images = target.finder.find(laid.points, vertex_normals(laid.points, source.mesh.faces), control=control)
    rotations = _smooth_rotations(source, laid.points)
    if back is None:
        whole = _whole_turn(source, laid.points, rotations)
        vectors = _vectors(source, rotations, whole, largest_turn)
        whole = _least_on_average(source, whole, vectors)
        turns = divided_turns(whole, vectors, source.limb_axes)
    else:
        # Both shapes then pass through the same rotations.
        there = back.inverse_turns_at(images, target.mesh)
        whole = there[0, 0]
        vectors = _vectors(source, rotations, whole, largest_turn, there[:, 1] + there[:, 2])
        turns = turns_with_twists(whole, vectors, there[:, 2])
    return _split(source, laid, images, turns, control)


def posed_deformation(
    deformation: ShapeDeformation, source: Carrier, before: TriangleMesh, target: TriangleMesh, control: Control
) -> ShapeDeformation:
    """Return the deformation between other poses of two shapes: all points keep the points that they are mapped to.

    Parameters
    ----------
    deformation : ShapeDeformation
        The deformation between the original poses.
    source : Carrier
        The deformed shape, in its new pose.
    before, target : TriangleMesh
        The carrier mesh of the other shape, in the original and the new pose.
    control : Control
        Stops the work.
    """
    images = deformation.images
    turned = surface_rotations(before.vertices, target.vertices, before.faces)
    nearest = before.faces[images.triangles, images.shares.argmax(axis=1)]
    beside = deformation.points - images.interpolated(before.corners)
    points = images.interpolated(target.corners) + np.einsum("nij,nj->ni", turned[nearest], beside)
    # Parts must rotate in the same sense from frame to frame.
    earlier = deformation.turns
    rotations = _smooth_rotations(source, points)
    whole = nearest_branches(_whole_turn(source, points, rotations)[None], earlier[:1, 0])[0]
    vectors = _vectors(source, rotations, whole, LARGEST_TURN, earlier[:, 1] + earlier[:, 2])
    turns = divided_turns(whole, vectors, source.limb_axes)
    return _split(source, Laid(points, deformation.confidence), images, turns, control)


def _split(
    source: Carrier, laid: Laid, images: ClosestPoints, turns: NDArray[np.float64], control: Control
) -> ShapeDeformation:
    """Divide a deformation with known images and rotations."""
    mesh, links, points = source.mesh, source.poisson.links, laid.points
    rotations = turn_matrices(mean_turns(turns, mesh.faces))
    stretches = np.swapaxes(rotations, 1, 2) @ deformation_gradients(mesh.vertices, points, mesh.faces)
    link_rotations = turn_matrices(mean_turns(turns, links.ends))
    deformed = np.einsum("kji,kj->ki", link_rotations, links.vectors(points))
    link_stretches = links.kept_across(links.vectors(mesh.vertices), deformed)
    control.check()
    pose = HingedPose.of(source.samples, mesh.vertices, points, turns)
    apart = points - hinged_points(source.samples, mesh.vertices, [pose], [1.0])
    offsets = np.einsum("nji,nj->ni", turn_matrices(turns), apart)
    scale = float(np.sqrt(TriangleMesh(points, mesh.faces).area / mesh.area))
    return ShapeDeformation(points, turns, stretches, link_stretches, pose, offsets, scale, images, laid.trust)


def _whole_turn(source: Carrier, points: NDArray[np.float64], rotations: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the shortest rotation vector, (3,), of most of a body that moves to points, (n, 3).

    It is that of most of its vertices, whose rotations are (n, 3, 3), unless their positions contradict it.
    """
    areas = source.mesh.vertex_areas
    turn = median_rotation(rotations, areas)
    start, end = (own - areas @ own / areas.sum() for own in (source.mesh.vertices, points))
    turned, still = (areas @ np.square(end - own).sum(axis=1) for own in (start @ turn.T, start))
    return rotation_vectors(turn[None])[0] if still >= _STAYS**2 * turned else np.zeros(3)


def _vectors(
    source: Carrier,
    rotations: NDArray[np.float64],
    whole: NDArray[np.float64],
    largest: float,
    guesses: NDArray[np.float64] | None = None,
) -> NDArray[np.float64]:
    """Return vectors of rotations, (n, 3), before that of the whole body; they are close to guesses, if given."""
    shortest = rotation_vectors(rotation_matrices(-whole[None]) @ rotations)
    # A link is the edge of a triangle that repeats a vertex.
    edges = mesh_edges(np.concatenate([source.mesh.faces, source.poisson.links.ends[:, [0, 1, 1]]]))
    if guesses is None:
        return unwound(shortest, edges, largest)
    return unwound_towards(shortest, guesses, edges, largest)


def _least_on_average(source: Carrier, whole: NDArray[np.float64], vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotation vector of a body, (3,), by full turns away, with which all of it turns least on average."""
    areas = source.mesh.vertex_areas
    mean = areas @ vectors / areas.sum()
    angle = np.linalg.norm(whole)
    axis = whole / angle if angle > 0.0 else mean / max(np.linalg.norm(mean), np.finfo(np.float64).tiny)
    turns = (whole + mean) @ axis / (2.0 * np.pi)
    return whole - 2.0 * np.pi * np.round(_CLEARLY * turns) * axis


def _smooth_rotations(source: Carrier, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the mean rotations of neighborhoods of every vertex, (n, 3, 3)."""
    centered = (points - points.mean(axis=0)) / source.mesh.root_area
    fits = source.unit.elastic.fits(centered, _TURN_WIDTH)
    turns = nearest_rotations(np.ascontiguousarray(np.moveaxis(fits, 0, 2))).rotations
    return np.ascontiguousarray(np.moveaxis(turns, 2, 0))
