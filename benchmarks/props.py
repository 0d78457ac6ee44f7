# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Props with sharp edges: extruded signs, solids of revolution, and things made of overlapping boxes and cylinders."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import PchipInterpolator

from convwass_addon.geometry.meshes.mesh import TriangleMesh, joined_meshes
from convwass_addon.geometry.meshes.welding import welded
from convwass_addon.geometry.plane.planar_fill import filled_boundary
from convwass_addon.geometry.remeshing.planar_mesh import planar_mesh
from convwass_addon.geometry.solids.prism import prism

Points = Sequence[tuple[float, float]]

# Half of the depth of signs, edge length of their triangles, sides of round things, and points of a smooth profile
# between two given ones.
_DEPTH, _EDGE, _SIDES, _BETWEEN = 0.25, 0.1, 64, 12


def extruded(rings: Sequence[ArrayLike], low: float = -_DEPTH, high: float = _DEPTH) -> TriangleMesh:
    """Extrude an area of the plane y = 0, given by its outline and those of its holes, (n, 2), along y."""
    area = planar_mesh(filled_boundary([np.asarray(ring, np.float64) for ring in rings], "even-odd"), _EDGE)
    solid = prism(area, (low, high))
    # The y axis points away from who sees x to the right and z up, so that triangles are turned over.
    return TriangleMesh(solid.vertices[:, [0, 2, 1]], solid.faces[:, ::-1])


def revolved(profile: ArrayLike, sides: int = _SIDES) -> TriangleMesh:
    """Revolve a profile, (n, 2), from the bottom to the top, about the z axis; both ends lie on it."""
    radii, heights = np.asarray(profile, np.float64).T
    angles = 2.0 * np.pi * np.arange(sides) / sides
    rings = np.stack([np.outer(np.cos(angles), radii), np.outer(np.sin(angles), radii)], axis=2)
    vertices = np.concatenate([rings, np.broadcast_to(heights, rings.shape[:2])[..., None]], axis=2).reshape(-1, 3)
    count = len(radii)
    around, along = (own.ravel() for own in np.meshgrid(np.arange(sides), np.arange(count - 1), indexing="ij"))
    here, there = around * count + along, (around + 1) % sides * count + along
    faces = [np.stack([here, there, there + 1], 1), np.stack([here, there + 1, here + 1], 1)]
    return welded(TriangleMesh(vertices, np.concatenate(faces)))


def smooth(profile: Points) -> NDArray[np.float64]:
    """Return a smooth profile through some points."""
    points = np.array(profile, np.float64)
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    places = np.concatenate([[0.0], np.cumsum(lengths)])
    found = PchipInterpolator(places, points)(np.linspace(0.0, places[-1], _BETWEEN * len(points)))
    found[[0, -1], 0] = 0.0
    return np.maximum(found, (0.0, -np.inf))


def box(low: ArrayLike, high: ArrayLike) -> TriangleMesh:
    """Return the box between two corners."""
    (x, y, z), (right, back, top) = low, high
    return extruded([[(x, z), (right, z), (right, top), (x, top)]], y, back)


def cylinder(radius: float, ends: tuple[ArrayLike, ArrayLike]) -> TriangleMesh:
    """Return the cylinder around the line between two points, which is parallel to an axis."""
    begin, end = (np.asarray(point, np.float64) for point in ends)
    axis = int(np.abs(end - begin).argmax())
    angles = 2.0 * np.pi * np.arange(_SIDES // 2) / (_SIDES // 2)
    half = 0.5 * abs(end[axis] - begin[axis])
    mesh = extruded([radius * np.column_stack([np.cos(angles), np.sin(angles)])], -half, half)
    # Cyclic permutations do not turn triangles over.
    return TriangleMesh(np.roll(mesh.vertices, axis - 1, axis=1) + 0.5 * (begin + end), mesh.faces)


def heart() -> TriangleMesh:
    """Return an extruded heart."""
    t = np.linspace(0.0, 2.0 * np.pi, 200, endpoint=False)
    height = 13.0 * np.cos(t) - 5.0 * np.cos(2 * t) - 2.0 * np.cos(3 * t) - np.cos(4 * t)
    return extruded([np.column_stack([16.0 * np.sin(t) ** 3, height])[::-1] / 16.0])


def star() -> TriangleMesh:
    """Return an extruded star of five tips."""
    angles = 0.5 * np.pi + np.arange(10) * np.pi / 5.0
    radii = np.where(np.arange(10) % 2, 0.45, 1.1)
    return extruded([np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])])


def arrow() -> TriangleMesh:
    """Return an extruded arrow to the right."""
    head = [(0.1, -0.7), (1.0, 0.0), (0.1, 0.7)]
    return extruded([[(-1.0, -0.25), (0.1, -0.25), *head, (0.1, 0.25), (-1.0, 0.25)]])


def tick() -> TriangleMesh:
    """Return an extruded check mark."""
    return extruded([[(-1.0, -0.05), (-0.3, -0.8), (1.0, 0.5), (0.7, 0.8), (-0.3, -0.2), (-0.7, 0.25)]])


def ring(gap: float = 0.0) -> TriangleMesh:
    """Return an extruded ring, or one with a gap of some radians to the right."""
    angles = np.linspace(0.5 * gap, 2.0 * np.pi - 0.5 * gap, 120, endpoint=gap > 0.0)
    arc = np.column_stack([np.cos(angles), np.sin(angles)])
    return extruded([arc, 0.6 * arc] if gap == 0.0 else [np.concatenate([arc, 0.6 * arc[::-1]])])


def pawn() -> TriangleMesh:
    """Return a pawn."""
    foot = [(0.0, 0.0), (0.5, 0.0), (0.5, 0.12), (0.38, 0.2), (0.22, 0.35), (0.17, 0.7)]
    return revolved(smooth([*foot, (0.3, 0.8), (0.2, 0.86), (0.27, 1.05), (0.2, 1.22), (0.0, 1.3)]))


def rook() -> TriangleMesh:
    """Return a rook without battlements."""
    foot = [(0.0, 0.0), (0.55, 0.0), (0.55, 0.12), (0.4, 0.2), (0.32, 0.4), (0.28, 1.0)]
    return revolved([*foot, (0.4, 1.1), (0.4, 1.4), (0.28, 1.4), (0.28, 1.25), (0.0, 1.25)])


def bottle() -> TriangleMesh:
    """Return a bottle."""
    body = [(0.0, 0.0), (0.4, 0.0), (0.42, 0.1), (0.42, 1.0), (0.35, 1.2)]
    return revolved(smooth([*body, (0.13, 1.4), (0.12, 1.8), (0.15, 1.85), (0.13, 1.9), (0.0, 1.9)]))


def goblet() -> TriangleMesh:
    """Return a goblet with a thick wall."""
    foot = [(0.0, 0.0), (0.42, 0.0), (0.4, 0.08), (0.12, 0.15), (0.1, 0.4), (0.16, 0.5), (0.1, 0.6)]
    return revolved(smooth([*foot, (0.45, 0.85), (0.5, 1.4), (0.42, 1.4), (0.36, 0.95), (0.0, 0.85)]))


def wine_glass() -> TriangleMesh:
    """Return a wine glass with a thin wall."""
    foot = [(0.0, 0.0), (0.4, 0.0), (0.38, 0.05), (0.06, 0.1), (0.05, 0.7), (0.25, 0.8), (0.42, 1.1), (0.38, 1.5)]
    return revolved(smooth([*foot, (0.35, 1.5), (0.385, 1.1), (0.23, 0.84), (0.0, 0.78)]))


def vase() -> TriangleMesh:
    """Return a hollow vase with edges."""
    wall = [(0.0, 0.0), (0.3, 0.0), (0.45, 0.3), (0.5, 0.6), (0.35, 1.0), (0.25, 1.2), (0.35, 1.4)]
    return revolved([*wall, (0.3, 1.4), (0.2, 1.2), (0.3, 1.0), (0.45, 0.6), (0.4, 0.3), (0.25, 0.06), (0.0, 0.06)])


def bowl() -> TriangleMesh:
    """Return a bowl on a foot."""
    outside = [(0.0, 0.0), (0.35, 0.0), (0.38, 0.05), (0.7, 0.35), (0.85, 0.7)]
    return revolved(smooth([*outside, (0.79, 0.7), (0.64, 0.4), (0.3, 0.12), (0.0, 0.1)]))


def barrel() -> TriangleMesh:
    """Return a barrel."""
    return revolved(smooth([(0.0, 0.0), (0.42, 0.0), (0.5, 0.3), (0.54, 0.6), (0.5, 0.9), (0.42, 1.2), (0.0, 1.2)]))


def lying(upright: TriangleMesh) -> TriangleMesh:
    """Return a shape that lies on its side, with its top to the right."""
    # A cyclic permutation does not turn triangles over.
    turned = np.roll(upright.vertices, 1, axis=1)
    return TriangleMesh(turned - (0.0, 0.0, turned[:, 2].min()), upright.faces)


def table() -> TriangleMesh:
    """Return a table of five boxes."""
    legs = [box((x, y, 0.0), (x + 0.14, y + 0.14, 1.25)) for x in (-1.0, 0.86) for y in (-0.6, 0.46)]
    return joined_meshes([box((-1.05, -0.65, 1.2), (1.05, 0.65, 1.35)), *legs])


def crate() -> TriangleMesh:
    """Return a box that is as high as wide."""
    return box((-0.7, -0.7, 0.0), (0.7, 0.7, 1.4))


def sofa() -> TriangleMesh:
    """Return a sofa of four boxes, its front towards -Y."""
    arms = [box((x, -0.52, 0.13), (x + 0.25, 0.48, 0.9)) for x in (-1.4, 1.15)]
    return joined_meshes([box((-1.2, -0.5, 0.15), (1.2, 0.48, 0.6)), box((-1.2, 0.3, 0.5), (1.2, 0.5, 1.2)), *arms])


def bed() -> TriangleMesh:
    """Return a bed of three boxes, its foot towards -Y."""
    boards = [box((-0.85, y, 0.0), (0.85, y + 0.12, top)) for y, top in ((1.18, 1.3), (-1.3, 0.7))]
    return joined_meshes([box((-0.8, -1.2, 0.3), (0.8, 1.2, 0.6)), *boards])


def robot() -> TriangleMesh:
    """Return a robot of eight boxes."""
    limbs = [box((x, -0.2, 0.0), (x + 0.26, 0.2, 0.95)) for x in (-0.36, 0.1)]
    limbs += [box((x, -0.15, 0.8), (x + 0.2, 0.15, 1.65)) for x in (-0.62, 0.42)]
    head = [box((-0.25, -0.22, 1.75), (0.25, 0.22, 2.2)), box((-0.1, -0.1, 1.65), (0.1, 0.1, 1.8))]
    return joined_meshes(
        [box((-0.4, -0.25, 0.9), (0.4, 0.25, 1.7)), *head, box((-0.5, -0.1, 1.5), (0.5, 0.1, 1.62)), *limbs]
    )


def seat() -> TriangleMesh:
    """Return a chair of six boxes, its front towards -Y."""
    legs = [box((x, y, 0.0), (x + 0.1, y + 0.1, 0.95)) for x in (-0.48, 0.38) for y in (-0.48, 0.36)]
    return joined_meshes([box((-0.5, -0.5, 0.9), (0.5, 0.48, 1.0)), box((-0.49, 0.4, 0.95), (0.49, 0.5, 2.1)), *legs])


def car() -> TriangleMesh:
    """Return a car of two extruded bodies and four wheels, heading along +X."""
    cabin = extruded([[(-0.8, 0.7), (0.8, 0.7), (0.5, 1.25), (-0.6, 1.25)]], -0.55, 0.55)
    wheels = [_wheel(0.3, x, y) for x in (-0.9, 0.9) for y in (-0.55, 0.55)]
    return joined_meshes([box((-1.5, -0.6, 0.3), (1.5, 0.6, 0.75)), cabin, *wheels])


def locomotive() -> TriangleMesh:
    """Return a steam locomotive of boxes and cylinders, heading along +X."""
    boiler = cylinder(0.4, ((-0.4, 0.0, 0.9), (1.2, 0.0, 0.9)))
    chimney = cylinder(0.12, ((0.9, 0.0, 1.1), (0.9, 0.0, 1.7)))
    wheels = [_wheel(0.28, x, y) for x in (-0.7, 0.0, 0.7) for y in (-0.4, 0.4)]
    frame = [box((-1.1, -0.5, 0.4), (-0.3, 0.5, 1.7)), box((-1.1, -0.4, 0.35), (1.2, 0.4, 0.55))]
    return joined_meshes([boiler, chimney, *frame, *wheels])


def _wheel(radius: float, x: float, y: float) -> TriangleMesh:
    return cylinder(radius, ((x, y - 0.12, radius), (x, y + 0.12, radius)))
