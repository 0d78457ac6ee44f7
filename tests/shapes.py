# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes with known properties, made with NumPy only."""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation
from skimage.measure import marching_cubes

from convwass_addon.geometry.meshes.edges import face_components
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.plane.planar_fill import filled_boundary
from convwass_addon.geometry.remeshing.planar_mesh import planar_mesh
from convwass_addon.geometry.solids.prism import prism

_CUBE = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2)]
_CUBE += [(1, 3, 7), (1, 7, 5)]


def box(size=(1.0, 1.0, 1.0), center=(0.0, 0.0, 0.0), angles=(0.0, 0.0, 0.0)):
    """A cuboid of 12 triangles, rotated about its center."""
    corners = np.array([(x, y, z) for z in (-0.5, 0.5) for y in (-0.5, 0.5) for x in (-0.5, 0.5)]) * size
    return TriangleMesh.from_arrays(Rotation.from_euler("xyz", angles).apply(corners) + center, _CUBE)


def even_directions(count):
    """Evenly spread unit vectors."""
    k = np.arange(count) + 0.5
    z, angle = 1 - 2 * k / count, np.pi * (1 + 5**0.5) * k
    flat = np.sqrt(1 - z**2)
    return np.stack([flat * np.cos(angle), flat * np.sin(angle), z], axis=1)


def ball(radius=1.0, center=(0.0, 0.0, 0.0), points=1500):
    """The convex hull of evenly spread points on a sphere; its volume is slightly less than the sphere's."""
    return TriangleMesh.from_arrays(even_directions(points) * radius + center, _hull_faces(points).copy())


@cache
def _hull_faces(points):
    vertices = even_directions(points)
    faces = ConvexHull(vertices).simplices
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    inward = np.einsum("ij,ij->i", a, np.cross(b, c)) < 0
    faces[inward] = faces[inward, ::-1]
    return faces


def torus(major=1.0, minor=0.35, center=(0.0, 0.0, 0.0), segments=(48, 24)):
    """A torus about the z axis."""
    n, m = segments
    u, v = np.meshgrid(np.arange(n) * 2 * np.pi / n, np.arange(m) * 2 * np.pi / m, indexing="ij")
    ring = major + minor * np.cos(v)
    vertices = np.stack([ring * np.cos(u), ring * np.sin(u), minor * np.sin(v)], axis=-1).reshape(-1, 3) + center
    i, j = (x.ravel() for x in np.meshgrid(np.arange(n), np.arange(m), indexing="ij"))
    a, b = i * m + j, (i + 1) % n * m + j
    c, d = (i + 1) % n * m + (j + 1) % m, i * m + (j + 1) % m
    return TriangleMesh.from_arrays(vertices, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]))


def tube_with_caps(radius=0.7, height=4.0, sides=64):
    """A closed prism about the z axis, centered at the origin."""
    angle = 2 * np.pi * np.arange(sides) / sides
    rim = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    low, high = (np.c_[rim, np.full(sides, side * height / 2)] for side in (-1, 1))
    here = np.arange(sides)
    after = np.roll(here, -1)
    bottom, top = np.full(sides, 2 * sides), np.full(sides, 2 * sides + 1)
    faces = [(here, after, after + sides), (here, after + sides, here + sides)]
    faces += [(after, here, bottom), (here + sides, after + sides, top)]
    corners = np.concatenate([np.stack(triple, axis=1) for triple in faces])
    return TriangleMesh.from_arrays(np.r_[low, high, [(0, 0, -height / 2), (0, 0, height / 2)]], corners)


def spring(turns):
    """A wire with capped ends that winds about the z axis, three times as high as the wire is thick per turn."""
    return bent_tube(2.0 * np.pi * turns, rings=int(24 * turns), radius=1.0 / turns / 3.0, rise=2.0)


def bent_tube(turn, sides=12, rings=60, radius=0.3, rise=0.0):
    """A tube with capped ends, bent about the z axis by an angle; beyond a full turn, a ring with genus 0."""
    u = np.linspace(0.0, turn, rings)[:, None]
    v = np.arange(sides) * 2 * np.pi / sides
    away = 1.0 + radius * np.cos(v)
    points = np.stack([away * np.cos(u), away * np.sin(u), radius * np.sin(v) + rise * u / turn], -1)
    here = np.arange(sides)
    after = np.roll(here, -1)
    faces = []
    for i in range(rings - 1):
        low, high = i * sides, (i + 1) * sides
        faces += [
            np.stack([low + here, high + here, high + after], 1),
            np.stack([low + here, high + after, low + after], 1),
        ]
    first, last = rings * sides, rings * sides + 1
    faces += [np.stack([after, np.full(sides, first), here], 1)]
    faces += [np.stack([(rings - 1) * sides + here, np.full(sides, last), (rings - 1) * sides + after], 1)]
    ends = [[np.cos(a), np.sin(a), z] for a, z in ((0.0, 0.0), (turn, rise))]
    return TriangleMesh.from_arrays(np.concatenate([points.reshape(-1, 3), ends]), np.concatenate(faces))


PERSON = (
    ((0.0, 0.0, 1.62), (0.0, 0.0, 1.70), 0.11),
    ((0.0, 0.0, 1.45), (0.0, 0.0, 1.60), 0.055),
    ((0.0, 0.0, 1.00), (0.0, 0.0, 1.38), 0.15),
    *(((side * 0.15, 0.0, 1.42), (side * 0.80, 0.0, 1.25), 0.05) for side in (-1, 1)),
    *(((side * 0.10, 0.0, 0.95), (side * 0.14, 0.0, 0.08), 0.07) for side in (-1, 1)),
)


def body(cell=0.03):
    """A man made of capsules, 1.8 tall along z, extracted from a grid; the mesh has slivers."""
    return capsules(PERSON, (-1.0, -0.3, -0.1), (1.0, 0.3, 1.95), cell)


def capsules(limbs, low, high, cell):
    """The union of capsules, as (start, end, radius), extracted from a grid between two corners."""
    axes = [np.arange(first, last, cell) for first, last in zip(low, high, strict=True)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    distance = np.full(points.shape[:3], np.inf)
    for start, end, radius in limbs:
        along = np.subtract(end, start)
        share = np.clip((points - start) @ along / (along @ along), 0.0, 1.0)
        own = np.linalg.norm(points - start - share[..., None] * along, axis=-1) - radius
        distance = np.minimum(distance, own)
    vertices, faces, _, _ = marching_cubes(distance, 0.0, spacing=(cell,) * 3)
    return TriangleMesh.from_arrays(vertices + np.array(low), faces)


def square(size=1.0, center=(0.0, 0.0, 0.0)):
    """A flat square without volume."""
    corners = np.array([(-0.5, -0.5, 0), (0.5, -0.5, 0), (0.5, 0.5, 0), (-0.5, 0.5, 0)]) * size + center
    return TriangleMesh.from_arrays(corners, [(0, 1, 2), (0, 2, 3)])


def shuffled(mesh, seed=0):
    """The mesh with vertices and faces in random order, and the new index of every vertex."""
    rng = np.random.default_rng(seed)
    order = rng.permutation(len(mesh.vertices))
    place = np.argsort(order)
    return TriangleMesh(mesh.vertices[order], place[mesh.faces][rng.permutation(len(mesh.faces))]), place


def renumbered(mesh):
    """The same surface with vertices and faces in random order."""
    return shuffled(mesh)[0]


def joined(*meshes):
    """Several meshes combined into one."""
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes[:-1])])
    faces = [mesh.faces + start for mesh, start in zip(meshes, starts, strict=True)]
    return TriangleMesh.from_arrays(np.concatenate([mesh.vertices for mesh in meshes]), np.concatenate(faces))


def piece_count(mesh):
    """Number of components that share no vertex."""
    return len(np.unique(face_components(mesh.faces)))


def with_faces(mesh, keep):
    """The mesh with only some of its faces."""
    return TriangleMesh.from_arrays(mesh.vertices, mesh.faces[keep])


def turned(mesh, angle):
    """A mesh rotated about the z axis through the origin."""
    c, s = np.cos(angle), np.sin(angle)
    return TriangleMesh(mesh.vertices @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]), mesh.faces)


def bent(points, angle):
    """Points after the z axis has been bent into an arc toward y."""
    low, high = points[:, 2].min(), points[:, 2].max()
    radius = (high - low) / angle
    turn, out = (points[:, 2] - (low + high) / 2) / radius, radius - points[:, 1]
    return np.stack([points[:, 0], radius - out * np.cos(turn), out * np.sin(turn)], axis=1)


def smallest_angles(mesh):
    """The smallest angle of every triangle in degrees."""
    sides = np.roll(mesh.corners, -1, axis=1) - mesh.corners
    sides /= np.linalg.norm(sides, axis=2, keepdims=True)
    return np.degrees(np.arccos(-np.einsum("fcd,fcd->fc", sides, np.roll(sides, 1, axis=1)))).min(axis=1)


def extruded(*rings, low=-0.2, high=0.2, edge=0.1):
    """Return the solid over a flat area, (n, 2) rings filled by the even-odd rule, from z = low to z = high."""
    return prism(planar_mesh(filled_boundary(list(rings), "even-odd"), edge), (low, high))


def rotated(mesh, vector):
    """Return a mesh rotated about the origin by a rotation vector."""
    return TriangleMesh(Rotation.from_rotvec(vector).apply(mesh.vertices), mesh.faces)
