# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The dual of a marching-cubes surface: one vertex per surface patch in a cube, one quad per crossed grid edge.

After Nielson, "Dual marching cubes", IEEE Visualization 2004. Marching cubes produces slivers where the surface passes
close to a sample; the dual has the same topology and no slivers. If two patches share two contour segments of a face,
or a patch is not a disk, the plain dual is not a manifold; such patches are first split into their triangles.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays.components import component_labels
from ..meshes.mesh import TriangleMesh

# Cubes with more triangles might hold a tube and a disk, whose Euler numbers add up to that of a single disk.
_MOST_OF_ONE_DISK = 6
# Minimum number of corners of a patch with two segments on one face.
_LEAST_OF_A_DOUBLE = 6


@dataclass(frozen=True)
class DualSurface:
    """A closed surface of quads, and of triangles where quads would not be a manifold.

    Attributes
    ----------
    points : (n, 3) float64
        Close to the surface, in the space of the mesh.
    cubes : (n, 3) int64
        Low corner of the cube that each point lies in.
    quads : (q, 4) int64
        Counterclockwise seen from outside.
    triangles : (t, 3) int64
        Counterclockwise seen from outside.
    """

    points: NDArray[np.float64]
    cubes: NDArray[np.int64]
    quads: NDArray[np.int64]
    triangles: NDArray[np.int64]


def dual_surface(mesh: TriangleMesh, inside: NDArray[np.bool_]) -> DualSurface:
    """Return the dual of a surface extracted by marching cubes.

    Parameters
    ----------
    mesh : TriangleMesh
        Closed and oriented outward. Samples are at integer coordinates, and no vertex coincides with a sample.
    inside : (nx, ny, nz) bool
        Samples inside the surface.
    """
    cubes = _Cubes.of(mesh, inside.shape)
    patches = _Patches.of(mesh, cubes)
    owners, count = patches.owners, patches.count
    places = np.empty((count, 3), np.int64)
    places[owners] = cubes.low
    # Four patches surround every other vertex, one in each cube at its grid edge.
    irregular = ~cubes.on_edge
    irregular[mesh.faces[patches.split]] = True
    floor = cubes.floor[~irregular]
    quads = cubes.around(owners)[~irregular]
    rising = ~inside[tuple(floor.T)]
    quads[rising] = quads[rising, ::-1]
    centers, fans = _fans(mesh.faces, owners, irregular)
    fans[:, 0] += count
    return DualSurface(
        np.concatenate([_centroids(mesh, owners, count), mesh.vertices[centers]]),
        np.concatenate([places, cubes.floor[centers]]),
        quads,
        fans,
    )


def _centroids(mesh: TriangleMesh, owners: NDArray[np.int64], count: int) -> NDArray[np.float64]:
    """Return the mean of the triangles' centroids for every patch, (count, 3)."""
    a, b, c = np.ascontiguousarray(mesh.faces.T)
    found = np.empty((count, 3))
    for axis, along in enumerate(np.ascontiguousarray(mesh.vertices.T)):
        found[:, axis] = np.bincount(owners, along[a] + along[b] + along[c], count)
    return found / (3 * np.bincount(owners, minlength=count))[:, None]


@dataclass(frozen=True)
class _Cubes:
    """The cubes between samples that contain the vertices and triangles of a surface.

    Attributes
    ----------
    floor : (n, 3) int64
        Vertices rounded down.
    on_edge : (n,) bool
        Whether a vertex is on a grid edge; the others are inside cubes.
    low : (m, 3) int64
        Low corner of the cube of each triangle.
    number : (m,) int64
        Index of that cube among those with triangles.
    in_face : (m,) bool
        Triangles that lie in the face between two cubes, and may be assigned to the wrong one.
    slots : (m, 3) int64
        4 v + s for each corner v of a triangle: s is the index of its cube around the grid edge, counterclockwise seen
        from the edge's upper end.
    """

    floor: NDArray[np.int64]
    on_edge: NDArray[np.bool_]
    low: NDArray[np.int64]
    number: NDArray[np.int64]
    in_face: NDArray[np.bool_]
    slots: NDArray[np.int64]

    @classmethod
    def of(cls, mesh: TriangleMesh, shape: tuple[int, int, int]) -> _Cubes:
        strides = np.array([shape[1] * shape[2], shape[2], 1])
        corners = np.ascontiguousarray(mesh.faces.T)
        floor = np.floor(mesh.vertices)
        whole = floor == mesh.vertices
        floor = floor.astype(np.int64)
        low = np.empty((len(mesh.faces), 3), np.int64)
        in_face = np.zeros(len(low), bool)
        for axis in range(3):
            coordinate, is_whole = floor[:, axis].copy(), whole[:, axis].copy()
            a, b, c = (coordinate[own] for own in corners)
            low[:, axis] = np.minimum(np.minimum(a, b), c)
            flat = np.flatnonzero((a == b) & (b == c))
            in_face[flat] |= is_whole[mesh.faces[flat]].all(axis=1)
        cube = low @ strides
        # Marching cubes emits cubes in order, except for triangles in faces.
        order = np.argsort(cube, kind="stable")
        ordered = cube[order]
        number = np.empty(len(cube), np.int64)
        number[order] = np.cumsum(np.append(0, ordered[1:] != ordered[:-1])) if len(cube) else 0
        # The offset of the cube below the vertex and the axis of the grid edge determine the slot.
        axis = np.argmin(whole, axis=1)
        table = np.zeros((3, int(strides[0] + strides[1]) + 1), np.int64)
        for along in range(3):
            first, second = strides[(along + 1) % 3], strides[(along + 2) % 3]
            table[along, [0, first, first + second, second]] = np.arange(4)
        index = axis * table.shape[1] + floor @ strides
        slots = 4 * mesh.faces
        for corner, own in enumerate(corners):
            slots[:, corner] += table.ravel()[index[own] - cube]
        return cls(floor, whole.sum(axis=1) == 2, low, number, in_face, slots)

    def around(self, labels: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return labels of triangles, (m,), around the grid edge of every vertex, (n, 4); -1 where there is none."""
        found = np.full(4 * len(self.floor), -1, np.int64)
        for slot in self.slots.T:
            found[slot] = labels
        return found.reshape(-1, 4)


@dataclass(frozen=True)
class _Patches:
    """The patches, each of which becomes one vertex of the dual.

    Attributes
    ----------
    owners : (m,) int64
        Index of the patch of each triangle.
    split : (m,) bool
        Triangles that are their own patches.
    count : int
        Number of patches.
    """

    owners: NDArray[np.int64]
    split: NDArray[np.bool_]
    count: int

    @classmethod
    def of(cls, mesh: TriangleMesh, cubes: _Cubes) -> _Patches:
        """Form patches from connected triangles of a cube, as far as the dual stays a manifold."""
        labels, count, forced = cubes.number.copy(), int(cubes.number.max()) + 1, _at_face_triangles(mesh, cubes)
        rest = np.flatnonzero(~_one_disk(mesh, cubes, count)[labels] | forced)
        parts, part_count, disk = _parts(mesh.faces[rest], labels[rest], cubes.on_edge)
        labels[rest] = count + parts
        split = forced
        split[rest] |= ~disk[parts]
        split |= _doubled(cubes.around(labels), count + part_count)[labels]
        labels[split] = count + part_count + np.arange(np.count_nonzero(split))
        numbers = np.cumsum(np.bincount(labels) > 0) - 1
        return cls(numbers[labels], split, int(numbers[-1]) + 1)


def _at_face_triangles(mesh: TriangleMesh, cubes: _Cubes) -> NDArray[np.bool_]:
    """Return the triangles, (m,), of all cubes that touch a triangle in a face between cubes."""
    if not cubes.in_face.any():
        return np.zeros(len(mesh.faces), bool)
    touched = np.zeros(len(mesh.vertices), bool)
    touched[mesh.faces[cubes.in_face]] = True
    chosen = np.zeros(int(cubes.number.max()) + 1, bool)
    chosen[cubes.number[touched[mesh.faces].any(axis=1)]] = True
    return chosen[cubes.number]


def _one_disk(mesh: TriangleMesh, cubes: _Cubes, count: int) -> NDArray[np.bool_]:
    """Return which of `count` cubes certainly hold a single disk: one with two more corners than triangles."""
    around = cubes.around(cubes.number)[cubes.on_edge]
    corners = np.bincount(around[around >= 0], minlength=count)
    triangles = np.bincount(cubes.number, minlength=count)
    found = (corners - triangles == 2) & (triangles <= _MOST_OF_ONE_DISK)
    if not cubes.on_edge.all():
        found[cubes.number[~cubes.on_edge[mesh.faces].all(axis=1)]] = False
    return found


def _parts(
    faces: NDArray[np.int64], numbers: NDArray[np.int64], on_edge: NDArray[np.bool_]
) -> tuple[NDArray[np.int64], int, NDArray[np.bool_]]:
    """Group the triangles of each cube that share vertices: group of each, (m,), number of groups, and which are disks.

    The Euler number of a group is i + (n - m) / 2 for n corners on grid edges, i vertices inside and m triangles.
    """
    if not len(faces):
        return np.empty(0, np.int64), 0, np.empty(0, bool)
    keys, corners = np.unique(numbers[:, None] * len(on_edge) + faces, return_inverse=True)
    count = len(faces)
    labels = component_labels(np.repeat(np.arange(count), 3), corners.ravel() + count, count + len(keys))
    number = int(labels.max()) + 1
    outer = on_edge[keys % len(on_edge)]
    twice = np.bincount(labels[count:], np.where(outer, 1, 2), number) - np.bincount(labels[:count], minlength=number)
    return labels[:count], number, twice == 2


def _doubled(around: NDArray[np.int64], count: int) -> NDArray[np.bool_]:
    """Return which of `count` patches share two segments with another one, so that they must be split.

    Since a segment has two ends, the two patches of such a pair are consecutive around four vertices.
    """
    large = np.bincount(around[around >= 0], minlength=count) >= _LEAST_OF_A_DOUBLE
    one, other = around.ravel(), np.roll(around, -1, axis=1).ravel()
    chosen = (one >= 0) & (other >= 0) & large[one] & large[other]
    one, other = one[chosen], other[chosen]
    pairs, times = np.unique(np.minimum(one, other) * count + np.maximum(one, other), return_counts=True)
    found = np.zeros(count, bool)
    found[pairs[times > 2] // count] = True
    return found


def _fans(
    faces: NDArray[np.int64], owners: NDArray[np.int64], chosen: NDArray[np.bool_]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Create the dual's faces at chosen vertices, (n,) bool, as triangle fans around them.

    Returns
    -------
    centers : (c,) int64
        The chosen vertices where more than one patch meets.
    triangles : (t, 3) int64
        Index of the center, and two patches.
    """
    triangle, corner = np.nonzero(chosen[faces])
    center, after, before = (faces[triangle, (corner + step) % 3] for step in range(3))
    # The next triangle around the center begins at the last edge of this one.
    begins = center * len(chosen) + after
    order = np.argsort(begins)
    following = triangle[order[np.searchsorted(begins, center * len(chosen) + before, sorter=order)]]
    one, other = owners[triangle], owners[following]
    apart = one != other
    centers, numbers = np.unique(center[apart], return_inverse=True)
    return centers, np.stack([numbers, one[apart], other[apart]], axis=1)
