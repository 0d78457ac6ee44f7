# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Mean value coordinates: points as weighted averages of the vertices of a closed mesh, or of a polygon.

M. Floater, "Mean value coordinates", Computer Aided Geometric Design 20(1), 2003; Ju, Schaefer and Warren, "Mean value
coordinates for closed triangular meshes", 2005.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays.chunks import chunks
from ..meshes.closest_points import ClosestPointFinder
from ..meshes.mesh import TriangleMesh
from ..plane.plane_angles import signed_angles

# Pairs of a point and a triangle processed together; each needs a few hundred bytes.
_PAIRS = 1 << 17
# A point closer to the surface than this fraction of the mesh's size lies on it.
_ON_SURFACE = 1e-9
# A triangle is seen edge-on, and has no weight, if the determinant of the directions to its corners is below this.
_EDGE_ON = 1e-9
# Largest angle, in radians, at which a point sees a side of a polygon; at pi it is on the side.
_STRAIGHT = 3.1
# Newton's method for positive coordinates: steps, and the error of the mean, relative to the mesh's size, at which it
# stops.
_NEWTON_STEPS = 60
_EXACT = 1e-11


def mean_value_coordinates(points: ArrayLike, mesh: TriangleMesh) -> NDArray[np.float64]:
    """Return weights of the vertices whose weighted mean is each point.

    They are smooth inside, linear on every triangle of the surface, and nonnegative on convex meshes; on others some
    are negative, usually slightly.

    Parameters
    ----------
    points : (k, 3)
        Any points; on the surface the weights are barycentric coordinates.
    mesh : TriangleMesh
        Closed and consistently oriented. Vertices that no triangle uses get no weight.

    Returns
    -------
    (k, n) float64
        Each row sums to 1.
    """
    wanted = np.asarray(points, dtype=np.float64).reshape(-1, 3)
    weights = np.zeros((len(wanted), len(mesh.vertices)))
    closest = ClosestPointFinder(mesh.corners).find(wanted)
    on_surface = closest.distances <= _ON_SURFACE * mesh.diagonal
    on = np.flatnonzero(on_surface)
    np.add.at(weights, (on[:, None], mesh.faces[closest.triangles[on]]), closest.shares[on])
    off = np.flatnonzero(~on_surface)
    for part in chunks(len(off), max(1, _PAIRS // max(len(mesh.faces), 1))):
        weights[off[part]] = _summed(_triangle_weights(wanted[off[part]], mesh), mesh)
    return weights / weights.sum(axis=1, keepdims=True)


def _triangle_weights(points: NDArray[np.float64], mesh: TriangleMesh) -> NDArray[np.float64]:
    """Weights that every triangle gives its corners, (k, m, 3).

    The mean direction over a spherical triangle, an integral over its edges, is written as a combination of the
    directions to its corners (Floater, "Generalized barycentric coordinates", 2015, section 8).
    """
    offsets = mesh.vertices[None] - points[:, None]
    lengths = np.linalg.norm(offsets, axis=2)
    units = (offsets / np.where(lengths > 0, lengths, 1.0)[..., None])[:, mesh.faces]
    after, before = np.roll(units, -1, axis=2), np.roll(units, 1, axis=2)
    # For the edge opposite every corner: the normal of the plane through the edge and the point, and the angle it
    # spans.
    normals = np.cross(after, before)
    sines = np.linalg.norm(normals, axis=3)
    angles = np.arctan2(sines, np.einsum("kmci,kmci->kmc", after, before))
    safe = np.where(sines > 0, sines, 1.0)
    means = np.einsum("kmc,kmci->kmi", angles / safe, normals)
    determinants = np.einsum("kmi,kmi->km", units[:, :, 0], normals[:, :, 0])
    seen = np.abs(determinants) > _EDGE_ON
    scale = np.where(seen, determinants, 1.0)[..., None] * lengths[:, mesh.faces]
    weights = np.einsum("kmci,kmi->kmc", normals, means) / np.where(scale != 0, scale, 1.0)
    return np.where(seen[..., None], weights, 0.0)


def _summed(weights: NDArray[np.float64], mesh: TriangleMesh) -> NDArray[np.float64]:
    """Sum the weights of the triangles' corners, (k, m, 3), per vertex, (k, n)."""
    corners = mesh.faces.ravel()
    return np.stack([np.bincount(corners, row.ravel(), len(mesh.vertices)) for row in weights])


def polygon_coordinates(points: NDArray[np.float64], corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return weights of the corners of a polygon whose weighted mean is each point; close to a side, nearly.

    Parameters
    ----------
    points : (k, 2)
        Points inside.
    corners : (n, 2)
        Corners in order, clockwise or counterclockwise.

    Returns
    -------
    (k, n) float64
        Each row sums to 1.
    """
    toward = corners - points[:, None]
    least = np.finfo(np.float64).eps * np.ptp(corners, axis=0).max()
    away = np.maximum(np.linalg.norm(toward, axis=2), least)
    angles = signed_angles(toward, np.roll(toward, -1, axis=1))
    tangents = np.tan(0.5 * np.clip(angles, -_STRAIGHT, _STRAIGHT))
    weights = (tangents + np.roll(tangents, 1, axis=1)) / away
    return weights / weights.sum(axis=1, keepdims=True)


def positive_coordinates(
    weights: NDArray[np.float64], points: ArrayLike, vertices: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Make weights nonnegative while preserving their mean.

    Negative weights are set to zero and the others multiplied by a factor exp(lambda . vertex), which among all weights
    with the right mean changes them least (in relative entropy). A point that is not a mean of vertices with positive
    weight, such as any point outside the hull, has no such weights; its weights are not multiplied.

    Parameters
    ----------
    weights : (k, n)
        At least one of each row is positive.
    points : (k, 3)
        The desired means.
    vertices : (n, 3)
        Vertices of the mesh.

    Returns
    -------
    (k, n) float64
        Each row sums to 1.
    """
    wanted = np.asarray(points, dtype=np.float64).reshape(-1, 3)
    clamped = np.maximum(weights, 0.0)
    clamped /= clamped.sum(axis=1, keepdims=True)
    size = float(np.linalg.norm(np.ptp(vertices, axis=0))) or 1.0
    for row, point in enumerate(wanted):
        used = np.flatnonzero(clamped[row])
        tilted = _tilted(clamped[row, used], (vertices[used] - point) / size)
        if tilted is not None:
            clamped[row, used] = tilted
    return clamped


def _tilted(weights: NDArray[np.float64], offsets: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """Tilt weights exponentially until the mean of the offsets is zero; None if that is impossible.

    Newton's method with backtracking on the log-sum-exp, a convex function of three unknowns.
    """
    tilt, logs = np.zeros(3), np.log(weights)
    value, shares = _log_sum(logs)
    for _ in range(_NEWTON_STEPS):
        mean = shares @ offsets
        if np.linalg.norm(mean) < _EXACT:
            return shares
        spread = (offsets * shares[:, None]).T @ offsets - np.outer(mean, mean)
        step = np.linalg.lstsq(spread, -mean, rcond=1e-13)[0]
        decrease, length = mean @ step, 1.0
        while length > 1e-6:
            trial = tilt + length * step
            trial_value, trial_shares = _log_sum(logs + offsets @ trial)
            # The tolerance allows for rounding in the last steps.
            if trial_value <= value + 1e-4 * length * decrease + 1e-14:
                break
            length *= 0.5
        else:
            return None
        tilt, value, shares = trial, trial_value, trial_shares
    return None


def _log_sum(logs: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
    top = logs.max()
    terms = np.exp(logs - top)
    total = terms.sum()
    return float(top + np.log(total)), terms / total
