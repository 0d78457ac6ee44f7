# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The detail of the shapes on the blends between them, which are read at the resolution of a grid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from ...geometry.distortion import vertex_distortions
from ...geometry.facing_points import FacingShape
from ...geometry.normals import vertex_normals
from ...geometry.surface_detail import DetailedSurface, DetailSource, with_detail
from ...progress import UNINTERRUPTED, Control
from ..motions.motion import MovedShape
from .coinciding_solids import CoincidingSolids
from .morph_problem import MorphFrame, MorphProblem

# Transport is trusted to tell where detail belongs on a shape of the larger weight, and not at all of the smaller.
_UNKNOWN, _KNOWN = 0.5, 0.9

# Distortions up to the first leave the detail of a moved shape as it is, from the second on it is none any more. Half
# way 1 to 5 % of the vertices are above the first of a horse and a cow, 10 to 20 % of a chair and a man.
_SOUND, _CRUMPLED = 1.3, 2.0


@dataclass(frozen=True)
class Starts:
    """Where on its shapes a blend comes from, as far as the grid tells.

    Attributes
    ----------
    points : (k, n, 3)
        For every shape, the places of the vertices of the blend on its reading.
    certainty : (k, n) float64
        How far they are known, from 0 to 1.
    """

    points: NDArray[np.floating]
    certainty: NDArray[np.float64]


def detailed_blend(
    problem: MorphProblem,
    frame: MorphFrame,
    shapes: Sequence[FacingShape],
    occupancies: Sequence[NDArray[np.floating]],
    starts: Starts,
    control: Control = UNINTERRUPTED,
    reliabilities: Sequence[NDArray[np.float64]] | None = None,
) -> DetailedSurface:
    """Lay the detail of shapes onto a blend of them.

    Parameters
    ----------
    problem : MorphProblem
        Of these shapes.
    frame : MorphFrame
        The blend, with the volume that it should have in its record.
    shapes : sequence of FacingShape
        In the scene, outward.
    occupancies : sequence of (nx, ny, nz)
        Of the shapes.
    starts : Starts
        Where the vertices of the blend come from.
    control : Control
        Ends the work when cancelled.
    reliabilities : sequence of (v,), optional
        For every shape and every vertex of it, how far its surface is still its own, from 0 to 1.
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
    """Return how far a moved shape still has its own surface at its vertices, (n,): where it is not crumpled."""
    distortions = vertex_distortions(shape.rest, shape.vertices)
    return np.clip((_CRUMPLED - distortions) / (_CRUMPLED - _SOUND), 0.0, 1.0)


def starts_of_transport(frame: MorphFrame) -> Starts:
    """Return where transport takes the vertices of a blend from; it is sure of that next to the shapes only."""
    certainty = np.repeat(_certainty(frame.blend.weights)[:, None], frame.origins.shape[1], axis=1)
    return Starts(frame.origins, certainty)


def starts_on_readings(problem: MorphProblem, frame: MorphFrame, solids: CoincidingSolids) -> Starts:
    """Return where on moved shapes the vertices of a blend come from.

    Where the shapes coincide that is straight above or below; elsewhere it is where transport takes them from. The mean
    of all, with the weights, is the vertex.

    Parameters
    ----------
    problem : MorphProblem
        Of the moved shapes, whose centers are one point.
    frame : MorphFrame
        The blend; without origins where the shapes coincide everywhere.
    solids : CoincidingSolids
        The shapes.
    """
    lattice, mesh, weights = problem.lattice, frame.mesh, frame.blend.weights
    at = partial(_sampled, low=lattice.origin + lattice.centers[0], spacing=lattice.spacing, points=mesh.vertices)
    depths = np.stack([at(depth) for depth in solids.depths])
    heights = lattice.spacing * (depths - np.asarray(weights) @ depths)
    points = mesh.vertices + heights[..., None] * vertex_normals(mesh.vertices, mesh.faces)
    if frame.origins is None:
        return Starts(points, np.ones(points.shape[:2]))
    agreement = at(solids.agreement)
    certainty = agreement + (1.0 - agreement) * _certainty(weights)[:, None]
    return Starts(agreement[:, None] * points + (1.0 - agreement)[:, None] * frame.origins, certainty)


def _certainty(weights: Sequence[float]) -> NDArray[np.float64]:
    """Return how sure transport is of where on every shape matter comes from, (k,): the more, the nearer the blend."""
    share = np.clip((np.asarray(weights) - _UNKNOWN) / (_KNOWN - _UNKNOWN), 0.0, 1.0)
    return share**2 * (3.0 - 2.0 * share)


def _sampled(
    values: NDArray[np.floating], low: NDArray[np.float64], spacing: float, points: NDArray[np.float64]
) -> NDArray[np.floating]:
    """Interpolate values of cells at points in the scene, (n, 3); `low` is the corner of the first cell."""
    return map_coordinates(values, ((points - low) / spacing - 0.5).T, order=1, mode="nearest")
