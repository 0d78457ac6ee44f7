# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Links between components of a mesh that lie close to each other, such as eyes and a head, to move them as one."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..progress import Control
from .edges import vertex_components
from .mesh import TriangleMesh
from .poisson_deformation import Links

# Components get at most so many links each.
_LINKS = 8
# Links are as long as the shortest one of their component, times this, at most.
_LONGER = 1.5
# The weight of a link without length, and the length at which it has fallen by e, in sizes of the surface (the square
# root of its area).
_WEIGHT, _REACH = 0.5, 0.05
# Lighter links are none.
_LEAST_WEIGHT = 1e-3
# Components of up to so many vertices are looked around in the tree of all vertices.
_SMALL = 64


def component_links(mesh: TriangleMesh, control: Control) -> Links:
    """Link every component with the closest vertices of other components, where those are near.

    Vertices without triangles are components of their own.
    """
    labels = vertex_components(mesh)
    loose = labels < 0
    labels[loose] = labels.max(initial=-1) + 1 + np.arange(loose.sum())
    sizes = np.bincount(labels)
    if len(sizes) < 2:
        return Links.none()
    size = np.sqrt(mesh.area)
    ends, lengths = [np.empty((0, 2), np.int64)], [np.empty(0)]
    for own, found in _closest_outside(mesh.vertices, labels, sizes, control):
        nearest = np.argsort(found[0], kind="stable")
        near = nearest[found[0][nearest] <= _LONGER * found[0][nearest[0]] + 1e-3 * size]
        # Some of all lengths, for the shortest ones lie side by side.
        chosen = near[np.unique(np.linspace(0, len(near) - 1, _LINKS).astype(np.int64))]
        ends.append(np.stack([own[chosen], found[1][chosen]], axis=1))
        lengths.append(found[0][chosen])
    weights = _WEIGHT * np.exp(-np.square(np.concatenate(lengths) / (_REACH * size)))
    kept = weights > _LEAST_WEIGHT
    return Links(np.concatenate(ends)[kept], weights[kept])


def _closest_outside(
    points: NDArray[np.float64], labels: NDArray[np.int64], sizes: NDArray[np.int64], control: Control
) -> Iterator[tuple[NDArray[np.int64], tuple[NDArray[np.float64], NDArray[np.int64]]]]:
    """Yield the vertices of every component but the largest, and the nearest of other components for each."""
    tree = cKDTree(points)
    members = np.split(np.argsort(labels, kind="stable"), np.cumsum(sizes)[:-1])
    largest = int(sizes.argmax())
    for label, own in enumerate(members):
        if label == largest:
            continue
        control.check()
        if len(own) > _SMALL:
            others = np.flatnonzero(labels != label)
            distances, nearest = cKDTree(points[others]).query(points[own])
            yield own, (distances, others[nearest])
            continue
        distances, nearest = tree.query(points[own], min(len(own) + 1, len(points)))
        outside = (labels[nearest] != label).argmax(axis=1)
        rows = np.arange(len(own))
        yield own, (distances[rows, outside], nearest[rows, outside])
