# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Links between nearby connected components of a mesh, such as eyes and a head, to move them as one."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...progress import Control
from ..arrays.label_groups import label_groups
from ..meshes.edges import vertex_components
from ..meshes.mesh import TriangleMesh
from .poisson_deformation import Links

# Largest number of links per component.
_LINKS = 8
# Largest length of a link, as a multiple of the shortest one of its component.
_LONGER = 1.5
# Weight of a link of length zero, and the length at which the weight has fallen by a factor of e, relative to the size
# of the surface (the square root of its area).
_WEIGHT, _REACH = 0.5, 0.05
# Links with less weight are dropped.
_LEAST_WEIGHT = 1e-3
# Up to this many vertices, a component queries the tree of all vertices.
_SMALL = 64


def component_links(mesh: TriangleMesh, control: Control) -> Links:
    """Link every component to the closest vertices of other components, if those are near.

    Vertices without triangles count as components.
    """
    labels = vertex_components(mesh)
    loose = labels < 0
    labels[loose] = labels.max(initial=-1) + 1 + np.arange(loose.sum())
    sizes = np.bincount(labels)
    if len(sizes) < 2:
        return Links.none()
    size = mesh.root_area
    ends, lengths = [np.empty((0, 2), np.int64)], [np.empty(0)]
    for own, found in _closest_outside(mesh.vertices, labels, sizes, control):
        nearest = np.argsort(found[0], kind="stable")
        near = nearest[found[0][nearest] <= _LONGER * found[0][nearest[0]] + 1e-3 * size]
        # Choose links over the whole range of lengths, since the shortest ones are adjacent.
        chosen = near[np.unique(np.linspace(0, len(near) - 1, _LINKS).astype(np.int64))]
        ends.append(np.stack([own[chosen], found[1][chosen]], axis=1))
        lengths.append(found[0][chosen])
    weights = _WEIGHT * np.exp(-np.square(np.concatenate(lengths) / (_REACH * size)))
    kept = weights > _LEAST_WEIGHT
    return Links(np.concatenate(ends)[kept], weights[kept], np.zeros(np.count_nonzero(kept), bool))


def _closest_outside(
    points: NDArray[np.float64], labels: NDArray[np.int64], sizes: NDArray[np.int64], control: Control
) -> Iterator[tuple[NDArray[np.int64], tuple[NDArray[np.float64], NDArray[np.int64]]]]:
    """Yield the vertices of every component but the largest, and for each its nearest vertex in other components."""
    tree = cKDTree(points)
    largest = int(sizes.argmax())
    for label, own in enumerate(label_groups(labels, len(sizes))):
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
