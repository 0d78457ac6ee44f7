# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Transfer materials, UV maps, colors and vertex groups of a mesh to a new mesh of the same surface."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.morphs.carried_uvs import UvMap, home_triangles
from ...geometry.meshes.closest_points import ClosestPointFinder, ClosestPoints
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.meshes.polygons import Polygons
from ..color_attributes import color_kind, color_names, is_per_corner, read_colors, write_colors
from ..element_values import MeshTriangles, triangle_materials, vectors_of
from ..rendered_maps import render_uv_map
from ..uv_maps import read_uvs, uv_names, write_uvs
from ..vertex_groups import group_names, read_groups, write_group


@dataclass(frozen=True)
class _Triangles:
    """The triangles of the old mesh.

    Attributes
    ----------
    corners : (m, 3, 3) float64
        Their corners.
    vertices, loops : (m, 3) int64
        The vertices and face corners there.
    materials : (m,) int64
        The material slots.
    """

    corners: NDArray[np.float64]
    vertices: NDArray[np.int64]
    loops: NDArray[np.int64]
    materials: NDArray[np.int64]

    @classmethod
    def of(cls, mesh: bpy.types.Mesh) -> _Triangles:
        triangles = MeshTriangles.of(mesh)
        vertices, loops = triangles.vertices.astype(np.int64), triangles.loops.astype(np.int64)
        corners = vectors_of(mesh.vertices)[vertices]
        return cls(corners, vertices, loops, triangle_materials(mesh).astype(np.int64))


@dataclass(frozen=True)
class _Places:
    """Where the new mesh lies on the old one.

    Attributes
    ----------
    finder : ClosestPointFinder
        Of the old triangles.
    points : ClosestPoints
        The new vertices on them.
    origins : (n, 3) float64
        These points.
    shape : TriangleMesh
        The new triangles.
    polygons : Polygons
        The new faces.
    """

    finder: ClosestPointFinder
    points: ClosestPoints
    origins: NDArray[np.float64]
    shape: TriangleMesh
    polygons: Polygons

    def homes(self, labels: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the old triangle that each new one belongs to, (f,); labels of the old triangles' parts, (m,)."""
        faces, owners = self.shape.faces, self.polygons.owners
        return home_triangles(self.finder, labels, self.points, faces, self.origins, owners=owners)


def carry_to_basis(source: bpy.types.Mesh, mesh: bpy.types.Mesh, shape: TriangleMesh, polygons: Polygons) -> None:
    """Give a new mesh the materials, UV maps, color attributes and vertex groups of an old one.

    No triangle extends across the texture: where a seam of a UV map or a border of materials runs through a face, the
    whole face belongs to one side.

    Parameters
    ----------
    source : bpy.types.Mesh
        The old mesh, without users.
    mesh : bpy.types.Mesh
        The new mesh, without users, with the faces of `polygons`.
    shape : TriangleMesh
        The new surface in the space of `source`.
    polygons : Polygons
        Made from the triangles of `shape`.
    """
    old = _Triangles.of(source)
    finder = ClosestPointFinder(old.corners)
    points = finder.find(shape.vertices)
    places = _Places(finder, points, points.interpolated(old.corners), shape, polygons)
    _carry_materials(source, mesh, old, places)
    with _holder(source) as giver, _holder(mesh) as receiver:
        _carry_uvs(giver, receiver, old, places)
        _carry_colors(giver, receiver, old, points)
        _carry_groups(giver, receiver, old, points)


@contextmanager
def _holder(mesh: bpy.types.Mesh) -> Iterator[bpy.types.Object]:
    """Provide an object that uses a mesh."""
    obj = bpy.data.objects.new("Holder", mesh)
    try:
        yield obj
    finally:
        bpy.data.objects.remove(obj)


def _carry_materials(source: bpy.types.Mesh, mesh: bpy.types.Mesh, old: _Triangles, places: _Places) -> None:
    for material in source.materials:
        mesh.materials.append(material)
    if len(source.materials) < 2:
        return
    of_triangles = old.materials[places.homes(old.materials)]
    slots = np.empty(len(mesh.polygons), np.int32)
    slots[places.polygons.owners] = of_triangles
    mesh.polygons.foreach_set("material_index", slots)


def _carry_uvs(giver: bpy.types.Object, receiver: bpy.types.Object, old: _Triangles, places: _Places) -> None:
    loops = np.arange(len(places.polygons.sources))
    for name in uv_names(giver):
        uv_map = UvMap(old.corners, old.vertices, read_uvs(giver, name)[old.loops])
        found = uv_map.at(places.points, places.shape.faces, places.origins, places.homes(uv_map.charts))
        write_uvs(receiver, name, loops, found.reshape(-1, 2)[places.polygons.sources])
    shown = render_uv_map(giver.data)
    if shown is not None:
        receiver.data.uv_layers[shown.name].active_render = True
        receiver.data.uv_layers.active = receiver.data.uv_layers[giver.data.uv_layers.active.name]


def _carry_colors(giver: bpy.types.Object, receiver: bpy.types.Object, old: _Triangles, points: ClosestPoints) -> None:
    for name in color_names(giver):
        corners = old.loops if is_per_corner(giver, name) else old.vertices
        write_colors(receiver, name, points.interpolated(read_colors(giver, name)[corners]), color_kind(giver, name))
    given, colors = giver.data.color_attributes, receiver.data.color_attributes
    if len(colors):
        colors.active_color_index, colors.render_color_index = given.active_color_index, given.render_color_index


def _carry_groups(giver: bpy.types.Object, receiver: bpy.types.Object, old: _Triangles, points: ClosestPoints) -> None:
    names = group_names(giver)
    if not names:
        return
    weights = read_groups(giver, names).T
    for name, values in zip(names, points.interpolated(weights[old.vertices]).T, strict=True):
        write_group(receiver, name, np.clip(values, 0.0, 1.0))
