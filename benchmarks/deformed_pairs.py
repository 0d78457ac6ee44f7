# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pairs of surfaces with exactly known correspondence: a shape, and the same shape deformed and remeshed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra
from scipy.spatial.transform import Rotation

from convwass_addon.geometry.meshes.closest_points import ClosestPointFinder, ClosestPoints
from convwass_addon.geometry.meshes.laplacian import laplacian
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.surface_graph import surface_graph
from convwass_addon.geometry.remeshing.coarsening import coarsened

from .blends import ASSETS, read_meshes

Deformation = Callable[[TriangleMesh], NDArray[np.float64]]
"""Returns new positions of the vertices."""

_AXES = np.eye(3)
# The shape is subdivided to this many vertices before it is coarsened, so that the source's vertices are evenly spread.
_FINE = 20_000
# Shorter distances on the surface of unit area are measured along straight lines: the vertices are too coarse for them.
_NEAR = 0.1


@dataclass(frozen=True)
class DeformedPair:
    """Two meshes and their correspondence.

    Attributes
    ----------
    name : str
    source, target : TriangleMesh
        Of unit area each, without common vertices or triangles.
    truth : (n, 3) float64
        For every vertex of the source, the corresponding point of the target.
    landmarks : (k, 2) int64
        Corresponding vertices of source and target, far apart, the most important first.
    mirrored : (n, 3) float64 or None
        The image of every vertex's mirror image; None if the shape is not symmetric.
    """

    name: str
    source: TriangleMesh
    target: TriangleMesh
    truth: NDArray[np.float64]
    landmarks: NDArray[np.int64]
    mirrored: NDArray[np.float64] | None


@dataclass(frozen=True)
class PairKind:
    """How to make a pair.

    Attributes
    ----------
    name, shape : str
        Name of the pair, and prefix of the shape's file name.
    deform : callable
        Deforms the shape, which is given in Blender's axes and with unit area.
    landmarks : tuple of int
        Numbers of landmarks to try.
    mirror : int or None
        The axis along which the shape is symmetric.
    """

    name: str
    shape: str
    deform: Deformation
    landmarks: tuple[int, ...]
    mirror: int | None = None


def bent(mesh: TriangleMesh, along: int, toward: int, angle: float) -> TriangleMesh:
    """Bend the axis `along` into an arc of `angle` radians toward another axis; lengths along the axis are kept."""
    points = mesh.vertices.copy()
    low, high = mesh.bounds[:, along]
    middle = mesh.bounds.mean(axis=0)
    radius = (high - low) / angle
    turn = (points[:, along] - middle[along]) / radius
    out = radius - (points[:, toward] - middle[toward])
    points[:, along] = middle[along] + out * np.sin(turn)
    points[:, toward] = middle[toward] + radius - out * np.cos(turn)
    return TriangleMesh(points, mesh.faces)


def twisted(mesh: TriangleMesh, along: int, angle: float) -> TriangleMesh:
    """Rotate one end relative to the other about the axis `along`, by `angle` radians in total."""
    low, high = mesh.bounds[:, along]
    middle = mesh.bounds.mean(axis=0)
    turn = angle * ((mesh.vertices[:, along] - low) / (high - low) - 0.5)
    turned = Rotation.from_rotvec(turn[:, None] * _AXES[along]).apply(mesh.vertices - middle)
    return TriangleMesh(turned + middle, mesh.faces)


def scaled_end(mesh: TriangleMesh, along: int, share: float, factor: float) -> TriangleMesh:
    """Smoothly scale the part beyond a fraction of an axis (measured from its upper end if positive)."""
    low, high = mesh.bounds[:, along]
    reach = (mesh.vertices[:, along] - low) / (high - low)
    if share < 0:
        reach = 1.0 - reach
    inside = _smooth((reach - (1.0 - abs(share))) / 0.2 + 0.5)
    center = np.average(mesh.vertices, axis=0, weights=inside)
    return TriangleMesh(mesh.vertices + ((factor - 1.0) * inside)[:, None] * (mesh.vertices - center), mesh.faces)


def posed(mesh: TriangleMesh, joints: int, reach: float, angle: float) -> TriangleMesh:
    """Rotate the outer parts of limbs about joints, like an armature with smooth weights.

    The limbs are at the `joints` vertices farthest from each other; each joint is at distance `reach` from the tip
    along the surface; axes and signs of the angles vary between limbs.
    """
    graph = surface_graph(mesh)
    points = mesh.vertices
    for number, tip in enumerate(far_apart(graph, joints)):
        away = dijkstra(graph, indices=tip)
        weight = _smooth((reach - away) / (0.5 * reach) + 0.5)
        near = np.abs(away - reach) < 0.25 * reach
        pivot = points[near].mean(axis=0)
        limb = points[tip] - pivot
        axis = np.cross(limb, _AXES[number % 3])
        turn = Rotation.from_rotvec((-1) ** number * angle * axis / np.linalg.norm(axis))
        points = points + weight[:, None] * (turn.apply(points - pivot) + pivot - points)
    return TriangleMesh(points, mesh.faces)


def _smooth(x: NDArray[np.float64]) -> NDArray[np.float64]:
    x = np.clip(x, 0.0, 1.0)
    return x * x * (3.0 - 2.0 * x)


def _mild_bend(mesh: TriangleMesh) -> NDArray[np.float64]:
    return bent(mesh, 1, 0, 1.0).vertices


def _spot_scaled(mesh: TriangleMesh) -> NDArray[np.float64]:
    mesh = scaled_end(scaled_end(mesh, 1, 0.3, 1.35), 2, 0.3, 1.25)
    return bent(twisted(mesh, 1, 0.6), 1, 0, 0.9).vertices


def _spot_strong(mesh: TriangleMesh) -> NDArray[np.float64]:
    return bent(twisted(mesh, 1, 0.6), 1, 0, 1.8).vertices


def _blub_strong(mesh: TriangleMesh) -> NDArray[np.float64]:
    return bent(mesh, 1, 0, 2.6).vertices


def _bob_scaled(mesh: TriangleMesh) -> NDArray[np.float64]:
    return bent(twisted(scaled_end(mesh, 2, 0.5, 1.4), 0, 0.6), 0, 1, 0.9).vertices


def _horse_posed(mesh: TriangleMesh) -> NDArray[np.float64]:
    return posed(mesh, 6, 0.25, 0.8).vertices


def _horse_scaled(mesh: TriangleMesh) -> NDArray[np.float64]:
    return bent(twisted(scaled_end(mesh, 0, 0.3, 1.35), 0, 0.6), 0, 1, 1.2).vertices


def _octopus_posed(mesh: TriangleMesh) -> NDArray[np.float64]:
    return posed(mesh, 8, 0.35, 0.7).vertices


def _bird_strong(mesh: TriangleMesh) -> NDArray[np.float64]:
    return bent(scaled_end(mesh, 1, 0.4, 1.3), 1, 2, 1.2).vertices


PAIRS = (
    PairKind("spotA", "spot", _mild_bend, (4,), mirror=0),
    PairKind("spotB", "spot", _spot_scaled, (4, 10), mirror=0),
    PairKind("spotC", "spot", _spot_strong, (4, 10), mirror=0),
    PairKind("blubC", "blub", _blub_strong, (4, 10), mirror=0),
    PairKind("bobB", "bob", _bob_scaled, (4, 10), mirror=1),
    PairKind("horse posed", "horse", _horse_posed, (4, 10), mirror=1),
    PairKind("horse scaled", "horse", _horse_scaled, (4, 10), mirror=1),
    PairKind("octopus posed", "octopus", _octopus_posed, (4, 10)),
    PairKind("bird bent", "bird", _bird_strong, (4, 10), mirror=1),
)
"""With strong bends and scaled parts, and nearly isometric ones."""


def shape_file(name: str, folder: Path | None) -> Path | None:
    """Return the file of a shape from the sample shapes or from a folder of other meshes; None if missing."""
    own = ASSETS / f"{name}.ply"
    if own.exists():
        return own
    found = sorted(folder.glob(f"{name}*tri*.obj")) if folder is not None else []
    return found[0] if found else None


def deformed_pair(kind: PairKind, file: Path, vertices: int = 1000) -> DeformedPair:
    """Make a pair of meshes with approximately this many vertices each."""
    (raw,) = read_meshes([file])
    rest = _unit_area(raw)
    moved = TriangleMesh(kind.deform(rest), rest.faces)
    moved = TriangleMesh(moved.vertices / moved.root_area, moved.faces)
    source = _spread_evenly(rest, vertices)
    target = decimated(moved, 2 * vertices)
    truth = _carried(source.vertices, rest, moved, target)
    mirrored = None
    if kind.mirror is not None:
        middle = rest.bounds.mean(axis=0)[kind.mirror]
        flipped = source.vertices.copy()
        flipped[:, kind.mirror] = 2.0 * middle - flipped[:, kind.mirror]
        mirrored = _carried(flipped, rest, moved, target)
    landmarks = _landmarks(source, target, truth, max(kind.landmarks))
    return DeformedPair(kind.name, source, target, truth, landmarks, mirrored)


def _unit_area(mesh: TriangleMesh) -> TriangleMesh:
    return TriangleMesh(mesh.vertices / mesh.root_area, mesh.faces)


def _spread_evenly(mesh: TriangleMesh, count: int) -> TriangleMesh:
    while len(mesh.vertices) < _FINE:
        mesh = subdivided(mesh)
    return coarsened(mesh, laplacian(mesh).areas, count).mesh


def subdivided(mesh: TriangleMesh) -> TriangleMesh:
    """Split every triangle into four at the midpoints of its edges."""
    ends = np.sort(np.stack([mesh.faces, np.roll(mesh.faces, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    edges, numbers = np.unique(ends, axis=0, return_inverse=True)
    ab, bc, ca = (numbers.reshape(-1, 3) + len(mesh.vertices)).T
    a, b, c = mesh.faces.T
    faces = np.concatenate([np.stack(corners, 1) for corners in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    return TriangleMesh(np.concatenate([mesh.vertices, mesh.vertices[edges].mean(axis=1)]), faces)


def decimated(mesh: TriangleMesh, triangles: int) -> TriangleMesh:
    """Collapse edges with Blender's modifier, which keeps more vertices in curved regions; shuffle the vertices."""
    data = bpy.data.meshes.new("fine")
    data.from_pydata(mesh.vertices.tolist(), [], mesh.faces.tolist())
    obj = bpy.data.objects.new("fine", data)
    bpy.context.scene.collection.objects.link(obj)
    modifier = obj.modifiers.new("decimate", "DECIMATE")
    modifier.ratio = triangles / len(mesh.faces)
    found = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    found.calc_loop_triangles()
    vertices = [vertex.co[:] for vertex in found.vertices]
    faces = [triangle.vertices[:] for triangle in found.loop_triangles]
    bpy.data.objects.remove(obj)
    # Shuffled, so that no method can use the order.
    order = np.random.default_rng(1).permutation(len(vertices))
    rank = np.argsort(order)
    return TriangleMesh.from_arrays(np.array(vertices)[order], rank[np.array(faces)])


def _carried(
    points: NDArray[np.float64], rest: TriangleMesh, moved: TriangleMesh, target: TriangleMesh
) -> NDArray[np.float64]:
    """Return points of the resting shape carried to the target."""
    found = ClosestPointFinder(rest.corners).find(points)
    return snapped(found.interpolated(moved.corners), target)


def snapped(points: NDArray[np.float64], mesh: TriangleMesh) -> NDArray[np.float64]:
    """Return the closest points of a mesh."""
    return ClosestPointFinder(mesh.corners).find(points).interpolated(mesh.corners)


def _landmarks(source: TriangleMesh, target: TriangleMesh, truth: NDArray[np.float64], count: int) -> NDArray[np.int64]:
    """Pick points far apart, and around each the vertex whose image is nearest to a vertex of the target."""
    graph = surface_graph(source)
    offsets = np.linalg.norm(truth[:, None] - target.vertices, axis=2)
    nearest, gaps = offsets.argmin(axis=1), offsets.min(axis=1)
    pairs = []
    for tip in far_apart(graph, count):
        around = np.flatnonzero(dijkstra(graph, indices=tip) < 2.0 * np.sqrt(1.0 / len(source.vertices)))
        best = around[gaps[around].argmin()]
        pairs.append((best, nearest[best]))
    return np.array(pairs, np.int64)


def far_apart(graph: csr_array, count: int) -> list[int]:
    """Choose vertices far from each other by farthest-point sampling; the first is farthest from some other vertex."""
    first = int(dijkstra(graph, indices=0).argmax())
    chosen = [first]
    away = dijkstra(graph, indices=first)
    while len(chosen) < count:
        chosen.append(int(away.argmax()))
        away = np.minimum(away, dijkstra(graph, indices=chosen[-1]))
    return chosen


class Geodesics:
    """Distances between points of one surface.

    Parameters
    ----------
    mesh : TriangleMesh
        Of unit area.
    """

    def __init__(self, mesh: TriangleMesh) -> None:
        self._mesh = mesh
        self._between = dijkstra(surface_graph(mesh), directed=False)
        self._finder = ClosestPointFinder(mesh.corners)

    @property
    def finder(self) -> ClosestPointFinder:
        """Finds closest points of the surface."""
        return self._finder

    def between(self, points: NDArray[np.float64], others: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the distances between corresponding points of two arrays, (n, 3)."""
        first, second = (self._finder.find(some) for some in (points, others))
        i, j = (self._mesh.faces[found.triangles] for found in (first, second))
        far = np.einsum("na,nb,nab->n", first.shares, second.shares, self._between[i[:, :, None], j[:, None]])
        straight = np.linalg.norm(points - others, axis=1)
        blurred = self._to_corners(first) + self._to_corners(second)
        return np.where(far < _NEAR + blurred, straight, np.maximum(far, straight))

    def _to_corners(self, found: ClosestPoints) -> NDArray[np.float64]:
        """Return mean distances of points to the corners of their triangles, weighted by barycentric coordinates."""
        corners = self._mesh.corners[found.triangles]
        offsets = corners - found.interpolated(self._mesh.corners)[:, None]
        return np.einsum("nc,nc->n", found.shares, np.linalg.norm(offsets, axis=2))
