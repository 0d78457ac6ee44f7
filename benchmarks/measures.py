# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures of blends: topology of meshes, width of borders, distance of surfaces."""

from __future__ import annotations

from dataclasses import dataclass

import bpy  # noqa: F401  mathutils is there once bpy has been imported
import numpy as np
from mathutils.bvhtree import BVHTree
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import distance_transform_edt
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from skimage.measure import find_contours

from convwass_addon.geometry.level_sets.isosurface import surface_at_level
from convwass_addon.geometry.meshes.mesh import TriangleMesh

# Components with a smaller fraction of the volume are crumbs: at 64 cells, a few cells.
_CRUMB_SHARE = 1e-3
# Triangles are subdivided this often before they are classified as inside or outside a sphere.
_HALVINGS = 2


@dataclass(frozen=True)
class Topology:
    """Topology of a closed surface.

    Attributes
    ----------
    pieces : int
        Connected solids.
    crumbs : int
        Solids with less than a thousandth of the volume.
    cavities : int
        Closed surfaces that face inward: bubbles.
    euler : int
        Vertices - edges + faces of all surfaces together.
    """

    pieces: int
    crumbs: int
    cavities: int
    euler: int

    @property
    def handles(self) -> int:
        """Number of handles of all surfaces: each lowers the Euler number of a closed surface, 2, by 2."""
        return self.pieces + self.cavities - self.euler // 2


def topology(mesh: TriangleMesh) -> Topology:
    """Count the components, bubbles and handles of a closed surface in which every edge has two triangles.

    Raises
    ------
    ValueError
        An edge does not have exactly two triangles.
    """
    tails, heads = mesh.faces.ravel(), np.roll(mesh.faces, -1, axis=1).ravel()
    keys = np.minimum(tails, heads) * len(mesh.vertices) + np.maximum(tails, heads)
    edges, counts = np.unique(keys, return_counts=True)
    if (counts != 2).any():
        raise ValueError(f"{int((counts != 2).sum())} edges do not have two triangles")
    size = len(mesh.vertices)
    graph = coo_array((np.ones(len(edges), bool), (edges // size, edges % size)), shape=(size, size))
    _, labels = connected_components(graph, directed=False)
    volumes = np.bincount(labels[mesh.faces[:, 0]], weights=mesh.face_volumes)
    used = np.bincount(labels[mesh.faces[:, 0]]) > 0
    is_piece = used & (volumes > 0)
    return Topology(
        pieces=int(is_piece.sum()),
        crumbs=int((is_piece & (volumes < _CRUMB_SHARE * mesh.volume)).sum()),
        cavities=int((used & ~is_piece).sum()),
        euler=len(np.unique(mesh.faces)) - len(edges) + len(mesh.faces),
    )


def edge_width(density: NDArray[np.float64], volume: float) -> float:
    """Return the width in cells over which a density falls from 90 to 10 % of its plateau.

    Parameters
    ----------
    density : (nx, ny, nz) or (nx, ny) float64
        A solid, or an image, with a soft border.
    volume : float
        Number of cells that the solid fills; the plateau is the median of that many densest cells.

    Returns
    -------
    float
        The volume between 90 and 10 % over the area of the surface at 50 %. Cells inside the solid with less than 90 %
        count as well, so barycenters, which are uneven inside, seem to have a wider border.
    """
    plateau = float(np.median(np.sort(density, axis=None)[::-1][: round(volume)]))
    band = int(((density > 0.1 * plateau) & (density < 0.9 * plateau)).sum())
    if density.ndim == 3:
        return band / surface_at_level(density, plateau / 2).mesh.area
    outlines = find_contours(np.pad(density, 1), plateau / 2)
    return band / sum(float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum()) for line in outlines)


def densest_cells(density: NDArray[np.float64], volume: float) -> NDArray[np.float64]:
    """Return 1 in the densest cells with the given total volume, and 0 elsewhere."""
    level = np.sort(density, axis=None)[::-1][round(volume)]
    return (density > level).astype(np.float64)


def overlap_with_ball(mesh: TriangleMesh) -> float:
    """Intersection over union of a closed mesh and the unit ball around the origin.

    Both are integrated along rays from the origin: a triangle at distance r contributes the signed cone below it, of
    which the fraction min(r, 1)^3 / r^3 is inside the ball. Triangles that face the origin subtract.
    """
    corners = mesh.corners
    for _ in range(_HALVINGS):
        corners = _halved(corners)
    a, b, c = np.moveaxis(corners, 1, 0)
    cones = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0
    distances = np.linalg.norm(corners.mean(axis=1), axis=1)
    common = float((cones * np.minimum(distances, 1.0) ** 3 / distances**3).sum())
    return common / (float(cones.sum()) + 4.0 / 3.0 * np.pi - common)


def _halved(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Split every triangle, (n, 3, 3), into four of half the size, (4 n, 3, 3)."""
    a, b, c = np.moveaxis(corners, 1, 0)
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return np.concatenate([np.stack(part, axis=1) for part in parts])


def thin_volume(filled: NDArray[np.bool_], radius: float) -> int:
    """Count the cells removed by a morphological opening with a ball of `radius` cells."""
    deep = distance_transform_edt(filled) > radius
    if not deep.any():
        return int(filled.sum())
    return int((filled & (distance_transform_edt(~deep) > radius)).sum())


def inside(points: NDArray[np.float64], mesh: TriangleMesh) -> NDArray[np.bool_]:
    """Tell which points, (n, 3), are inside a closed mesh: those behind the nearest triangle."""
    tree = _search_tree(mesh)
    found = [tree.find_nearest(point)[:2] for point in points.tolist()]
    nearest, normals = (np.array([hit[i] for hit in found]) for i in range(2))
    return np.einsum("ij,ij->i", points - nearest, normals) < 0


def mean_surface_distance(one: TriangleMesh, other: TriangleMesh) -> float:
    """Mean distance of the vertices of each mesh to the surface of the other, in the unit of the meshes."""
    return (_distance_to(one.vertices, other) + _distance_to(other.vertices, one)) / 2


def _distance_to(points: NDArray[np.float64], mesh: TriangleMesh) -> float:
    tree = _search_tree(mesh)
    return float(np.mean([tree.find_nearest(point)[3] for point in points.tolist()]))


def _search_tree(mesh: TriangleMesh) -> BVHTree:
    return BVHTree.FromPolygons(mesh.vertices.tolist(), mesh.faces.tolist(), all_triangles=True)


def largest_second_difference(curve: ArrayLike) -> tuple[float, int]:
    """Return the largest bend of a curve, (n,) or (n, d), and its index; 0 for a straight line.

    The second difference at k is c[k - 1] - 2 c[k] + c[k + 1]; for curves of points, its length.
    """
    bends = np.diff(np.asarray(curve, dtype=np.float64), n=2, axis=0)
    sizes = np.abs(bends) if bends.ndim == 1 else np.linalg.norm(bends, axis=1)
    where = int(sizes.argmax())
    return float(sizes[where]), where + 1
