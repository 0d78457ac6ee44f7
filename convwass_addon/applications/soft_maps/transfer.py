# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Transfer weights, colors and other values to another mesh along a point map."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError
from ...geometry.meshes.mesh import TriangleMesh
from .surface_maps import PointMap

# Weights below this are interpolation noise and set to zero.
_LEAST_WEIGHT = 1e-4


def transferred_values(points: PointMap, giver: TriangleMesh, values: ArrayLike) -> NDArray[np.float64]:
    """Transfer values from one mesh's vertices to another's.

    Parameters
    ----------
    points : PointMap
        A point on the giver for each vertex of the receiving mesh.
    giver : TriangleMesh
        The mesh that provides the values.
    values : (n,) or (n, d)
        Values at its vertices.

    Returns
    -------
    (m,) or (m, d) float64
        Zero for vertices without a point.

    Raises
    ------
    InputError
        The number of values differs from that of the vertices, or the map belongs to another mesh.
    """
    given = np.asarray(values, dtype=np.float64)
    check_giver(points, giver)
    if given.shape[:1] != (len(giver.vertices),):
        raise InputError("Transferred data must have one value for every vertex.")
    return points.at(giver, given)


def transferred_corner_values(points: PointMap, values: ArrayLike) -> NDArray[np.float64]:
    """Transfer values at the corners of one mesh's triangles, (f, 3, d), to another mesh's vertices, (m, d).

    Zero for vertices without a point. Colors may jump between the giver's triangles. For UVs, see :mod:`.transfer_uvs`:
    triangles of the receiver may cross their seams.

    Raises
    ------
    InputError
        Not three values for every triangle of the map.
    """
    given = np.asarray(values, dtype=np.float64)
    if given.ndim != 3 or given.shape[1] != 3 or len(given) <= points.faces.max(initial=-1):
        raise InputError("Transferred data must have three values for every triangle.")
    return np.einsum("nk,nkd->nd", points.barycentric.astype(np.float64), given[np.maximum(points.faces, 0)])


def transferred_weights(
    points: PointMap, giver: TriangleMesh, weights: ArrayLike, limit: int | None = None, normalize: bool = True
) -> NDArray[np.float64]:
    """Transfer weights of bones or groups to another mesh.

    Parameters
    ----------
    points : PointMap
        A point on the giver for each vertex of the receiving mesh.
    giver : TriangleMesh
        The mesh that provides the weights.
    weights : (g, n)
        Nonnegative weights of every vertex in every group.
    limit : int, optional
        Largest number of groups per vertex: the largest weights are kept and rescaled to the original sum.
    normalize : bool
        Whether to normalize the weights of every vertex that has any to sum 1, as bone deformation requires.

    Returns
    -------
    (g, m) float64
        From 0 to 1.

    Raises
    ------
    InputError
        Wrong shape, negative weights, or a limit below 1.
    """
    given = np.asarray(weights, dtype=np.float64)
    check_giver(points, giver)
    if given.ndim != 2 or given.shape[1] != len(giver.vertices):
        raise InputError("Weights must have one number for every group and vertex.")
    if not (np.isfinite(given).all() and (given >= 0).all()):
        raise InputError("Weights must be numbers that are not negative.")
    if limit is not None and limit < 1:
        raise InputError("The limit of groups per vertex must be at least 1.")
    taken = np.stack([points.at(giver, row) for row in given]) if len(given) else np.zeros((0, len(points)))
    taken[taken < _LEAST_WEIGHT] = 0.0
    if limit is not None and limit < len(taken):
        taken = _limited(taken, limit)
    if normalize:
        sums = taken.sum(axis=0)
        taken /= np.where(sums > 0, sums, 1.0)
    return np.minimum(taken, 1.0)


def check_giver(points: PointMap, giver: TriangleMesh) -> None:
    """Raise if a map refers to triangles that a mesh does not have.

    Raises
    ------
    InputError
        The mesh has changed.
    """
    if points.faces.max(initial=-1) >= len(giver.faces):
        raise InputError("The map belongs to a mesh with more faces; compute it again.")


def _limited(weights: NDArray[np.float64], limit: int) -> NDArray[np.float64]:
    """Keep the largest weights of every vertex, (g, m), rescaled to the original sum."""
    # The first groups win ties.
    order = np.argsort(-weights, axis=0, kind="stable")
    kept = weights.copy()
    np.put_along_axis(kept, order[limit:], 0.0, axis=0)
    sums = kept.sum(axis=0)
    return kept * (weights.sum(axis=0) / np.where(sums > 0, sums, 1.0))
