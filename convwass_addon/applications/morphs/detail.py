# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The detail of the shapes on the blends between them, which are read at the resolution of a grid."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from ...geometry.facing_points import FacingShape
from ...geometry.normals import vertex_normals
from ...geometry.surface_detail import DetailedSurface, DetailSource, with_detail
from ...progress import UNINTERRUPTED, Control
from .coinciding_solids import CoincidingSolids
from .morph_problem import MorphFrame, MorphProblem


def detailed_blend(
    problem: MorphProblem,
    frame: MorphFrame,
    shapes: Sequence[FacingShape],
    occupancies: Sequence[NDArray[np.floating]],
    starts: NDArray[np.floating],
    control: Control = UNINTERRUPTED,
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
    starts : (k, n, 3)
        Where the vertices of the blend come from, as far as the grid tells.
    control : Control
        Ends the work when cancelled.
    """
    lattice = problem.lattice
    sources = [
        DetailSource(
            shape=shapes[i],
            weight=float(frame.blend.weights[i]),
            starts=starts[i].astype(np.float64),
            filled=partial(_sampled, occupancies[i], lattice.origin + lattice.centers[i], lattice.spacing),
        )
        for i in np.flatnonzero(frame.blend.weights)
    ]
    amount, volume = problem.settings.carried_detail, frame.record["volume_wanted"]
    return with_detail(frame.mesh, sources, lattice.spacing, amount, volume, control)


def starts_on_readings(problem: MorphProblem, frame: MorphFrame, solids: CoincidingSolids) -> NDArray[np.float64]:
    """Return where on moved shapes the vertices of a blend come from, (k, n, 3), as far as the grid tells.

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
    lattice, mesh = problem.lattice, frame.mesh
    at = partial(_sampled, low=lattice.origin + lattice.centers[0], spacing=lattice.spacing, points=mesh.vertices)
    depths = np.stack([at(depth) for depth in solids.depths])
    heights = lattice.spacing * (depths - np.asarray(frame.blend.weights) @ depths)
    starts = mesh.vertices + heights[..., None] * vertex_normals(mesh.vertices, mesh.faces)
    if frame.origins is None:
        return starts
    agreement = at(solids.agreement)[:, None]
    return agreement * starts + (1.0 - agreement) * frame.origins


def _sampled(
    values: NDArray[np.floating], low: NDArray[np.float64], spacing: float, points: NDArray[np.float64]
) -> NDArray[np.floating]:
    """Interpolate values of cells at points in the scene, (n, 3); `low` is the corner of the first cell."""
    return map_coordinates(values, ((points - low) / spacing - 0.5).T, order=1, mode="nearest")
