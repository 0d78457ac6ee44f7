# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Add the detail of the shapes to blends, whose surfaces are extracted at the resolution of a grid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from ...geometry.arrays.steps import linear_step, smooth_step
from ...geometry.level_sets.surface_detail import DetailedSurface, DetailSource, with_detail
from ...geometry.meshes.distortion import vertex_distortions
from ...geometry.meshes.facing_points import FacingShape
from ...progress import Control
from ..motions.motion import MovedShape
from .coinciding_solids import CoincidingSolids
from .morph_problem import MorphFrame, MorphProblem

# Confidence in the origins given by transport: none up to the first weight of a shape, full from the second on.
_UNKNOWN, _KNOWN = 0.5, 0.9

# Where a blend is within so many cells of a moved shape, the shape's detail belongs there; from so many on it does not.
_RELATED, _UNRELATED = 1.0, 2.5

# The detail of a moved shape is kept up to the first distortion, and lost from the second on. Halfway, 1 to 5 % of the
# vertices exceed the first for a horse and a cow, and 10 to 20 % for a chair and a man.
_SOUND, _CRUMPLED = 1.3, 2.0


@dataclass(frozen=True)
class Starts:
    """Points of the shapes that the vertices of a blend come from, as far as the grid shows.

    Attributes
    ----------
    points : (k, n, 3)
        For every shape, points on its extracted surface, one per vertex of the blend.
    certainty : (k, n) float64
        Confidence in these points, from 0 to 1.
    """

    points: NDArray[np.floating]
    certainty: NDArray[np.float64]


def detailed_blend(
    problem: MorphProblem,
    frame: MorphFrame,
    shapes: Sequence[FacingShape],
    occupancies: Sequence[NDArray[np.floating]],
    starts: Starts,
    control: Control,
    reliabilities: Sequence[NDArray[np.float64]] | None = None,
) -> DetailedSurface:
    """Add the detail of shapes to a blend of them.

    Parameters
    ----------
    problem : MorphProblem
        The problem of these shapes.
    frame : MorphFrame
        The blend; its record holds the volume that it should have.
    shapes : sequence of FacingShape
        The shapes in scene space, oriented outward.
    occupancies : sequence of (nx, ny, nz)
        Occupancies of the shapes.
    starts : Starts
        Where the vertices of the blend come from.
    control : Control
        Ends the work when cancelled.
    reliabilities : sequence of (v,), optional
        For every vertex of every shape, how reliable the detail around it is, from 0 to 1.
    """
    lattice = problem.lattice
    sources = [
        DetailSource(
            shape=shapes[i],
            weight=float(frame.blend.weights[i]),
            starts=starts.points[i].astype(np.float64),
            certainty=starts.certainty[i],
            reliability=None if reliabilities is None else reliabilities[i],
            filled=partial(_sampled, occupancies[i], lattice.origin + lattice.centers[i], lattice.spacing),
        )
        for i in np.flatnonzero(frame.blend.weights)
    ]
    amount, volume = problem.settings.carried_detail, frame.record["volume_wanted"]
    face_size = problem.settings.face_size
    return with_detail(frame.mesh, sources, lattice.spacing, amount, volume, control, face_size)


def reliability_of(shape: MovedShape) -> NDArray[np.float64]:
    """Return the reliability of a moved shape's detail at its vertices, (n,): high where it is little distorted."""
    distortions = vertex_distortions(shape.rest, shape.vertices)
    return linear_step(distortions, _CRUMPLED, _SOUND)


def starts_of_transport(frame: MorphFrame) -> Starts:
    """Return the origins of the vertices according to transport, which is certain only next to the shapes."""
    certainty = np.repeat(_certainty(frame.blend.weights)[:, None], frame.origins.shape[1], axis=1)
    return Starts(frame.origins, certainty)


def starts_on_readings(problem: MorphProblem, frame: MorphFrame, solids: CoincidingSolids) -> Starts:
    """Return the points of moved shapes that the vertices of a blend come from.

    Where the shapes coincide, a point is straight above or below the vertex, on the shape's surface as the grid shows
    it; the further it is away, the less certain it is. Elsewhere transport gives it.

    Parameters
    ----------
    problem : MorphProblem
        The problem of the moved shapes, which have a common center.
    frame : MorphFrame
        The blend; it has no origins if the shapes coincide everywhere.
    solids : CoincidingSolids
        The shapes.
    """
    lattice, mesh, weights = problem.lattice, frame.mesh, frame.blend.weights
    at = partial(_sampled, low=lattice.origin + lattice.centers[0], spacing=lattice.spacing, points=mesh.vertices)
    depths = np.stack([at(depth) for depth in solids.depths])
    points = mesh.vertices + lattice.spacing * depths[..., None] * mesh.vertex_normals
    near = linear_step(np.abs(depths), _UNRELATED, _RELATED)
    if frame.origins is None:
        return Starts(points, near)
    agreement = at(solids.agreement)
    certainty = agreement * near + (1.0 - agreement) * _certainty(weights)[:, None]
    return Starts(agreement[:, None] * points + (1.0 - agreement)[:, None] * frame.origins, certainty)


def _certainty(weights: Sequence[float]) -> NDArray[np.float64]:
    """Return how certain transport is of origins on every shape, (k,): more for shapes of larger weight."""
    return smooth_step(weights, _UNKNOWN, _KNOWN)


def _sampled(
    values: NDArray[np.floating], low: NDArray[np.float64], spacing: float, points: NDArray[np.float64]
) -> NDArray[np.floating]:
    """Interpolate values of cells at points in scene space, (n, 3); `low` is the corner of the first cell."""
    return map_coordinates(values, ((points - low) / spacing - 0.5).T, order=1, mode="nearest")
