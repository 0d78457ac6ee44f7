# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces for densities: the vertices of an object's own mesh, at their positions after modifiers."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..geometry.algebra.affine import transformed_points
from ..geometry.arrays.chunks import chunks
from ..geometry.meshes.mesh import TriangleMesh
from ..sentence import Sentence
from .element_values import corner_vertices, triangle_corners, vertex_positions
from .matrix_checks import require_finite
from .mesh_checks import readable_mesh
from .visibility import current_objects, is_current, shown_objects

# fmt: off
KEEPS_VERTICES = frozenset((
    "ARMATURE", "CAST", "CLOTH", "COLLISION", "CORRECTIVE_SMOOTH", "CURVE", "DATA_TRANSFER", "DISPLACE",
    "DYNAMIC_PAINT", "HOOK", "LAPLACIANDEFORM", "LAPLACIANSMOOTH", "LATTICE", "MESH_CACHE", "MESH_DEFORM",
    "NORMAL_EDIT", "SHRINKWRAP", "SIMPLE_DEFORM", "SMOOTH", "SOFT_BODY", "SURFACE", "SURFACE_DEFORM",
    "UV_PROJECT", "UV_WARP", "VERTEX_WEIGHT_EDIT", "VERTEX_WEIGHT_MIX", "VERTEX_WEIGHT_PROXIMITY", "WARP",
    "WAVE", "WEIGHTED_NORMAL",
))
# fmt: on
"""Types of modifiers that keep the vertices."""

MAY_KEEP_VERTICES = frozenset(("NODES", "MESH_SEQUENCE_CACHE"))
"""Types of modifiers that may keep the vertices."""


@dataclass(frozen=True)
class SurfaceReading:
    """A surface and the modifiers ignored for it.

    Attributes
    ----------
    mesh : TriangleMesh
        World space; vertex i is vertex i of the object's own mesh.
    ignored : tuple of str
        Names of modifiers that are visible in the viewport and were ignored, because they change the vertices.
    """

    mesh: TriangleMesh
    ignored: tuple[str, ...] = ()


def ignored_notices(readings: Iterable[SurfaceReading]) -> list[Sentence]:
    """Return a notice about the modifiers that were ignored for some surfaces, if there are any."""
    names = dict.fromkeys(name for reading in readings for name in reading.ignored)
    if not names:
        return []
    return [Sentence("Modifiers that change the vertices are ignored: {names}.", {"names": ", ".join(names)})]


@dataclass(frozen=True)
class _Shape:
    """A mesh in local space.

    Attributes
    ----------
    vertices : (n, 3) float32
        Positions.
    faces : (m, 3) int32
        Triangles.
    """

    vertices: NDArray[np.float32]
    faces: NDArray[np.int32]


@dataclass(frozen=True)
class _Topology:
    """Identifies meshes with the same vertices: their number, and the vertex at every corner of every face."""

    count: int
    corners: NDArray[np.int32]

    @classmethod
    def of(cls, mesh: bpy.types.Mesh) -> _Topology:
        return cls(len(mesh.vertices), corner_vertices(mesh))

    def is_that_of(self, mesh: bpy.types.Mesh) -> bool:
        return self.count == len(mesh.vertices) and np.array_equal(self.corners, corner_vertices(mesh))


def same_vertices(first: bpy.types.Mesh, second: bpy.types.Mesh) -> bool:
    """Return whether two meshes have the same vertices at all corners of their faces, wherever these are."""
    return _Topology.of(first).is_that_of(second)


def surface_mesh(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> TriangleMesh:
    """Return the mesh of `read_surface`."""
    return read_surface(obj, depsgraph).mesh


def read_surface(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> SurfaceReading:
    """Extract the surface of an object in the scene, with the vertices of its own mesh.

    Current shape keys and modifiers that move vertices are applied; modifiers that change vertices, such as Subdivision
    Surface, are ignored. Hidden and masked faces belong to the surface; vertices without faces are kept and belong to
    no triangle.

    Parameters
    ----------
    obj : bpy.types.Object
        The original (not evaluated) mesh object, in any mode, hidden or not.
    depsgraph : bpy.types.Depsgraph
        ``context.evaluated_depsgraph_get()``; updated here.

    Raises
    ------
    InputError
        Not a mesh, no faces or none with an area, or coordinates that are not finite.
    """
    topology = _Topology.of(readable_mesh(obj))
    with current_objects([obj], depsgraph):
        evaluated = obj.evaluated_get(depsgraph)
        matrix = np.array(evaluated.matrix_world, dtype=np.float64)
        shape = _shape_if(topology, evaluated)
        if shape is not None:
            return SurfaceReading(_world(obj, shape, matrix))
        with _probe(obj, depsgraph) as probe:
            shape = _without_builders(probe, topology, depsgraph) or _shape(obj.data)
            kept = {modifier.name for modifier in probe.modifiers if modifier.show_viewport}
    shown = [modifier.name for modifier in obj.modifiers if modifier.show_viewport]
    return SurfaceReading(_world(obj, shape, matrix), tuple(name for name in shown if name not in kept))


@contextmanager
def _probe(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> Iterator[bpy.types.Object]:
    """Provide a copy of an object that is evaluated even if hidden, and whose modifiers may be removed."""
    probe = obj.copy()
    try:
        with shown_objects([probe], depsgraph.scene):
            yield probe
    finally:
        bpy.data.objects.remove(probe)


def _without_builders(probe: bpy.types.Object, topology: _Topology, depsgraph: bpy.types.Depsgraph) -> _Shape | None:
    """Remove the modifiers that change the vertices of an object, and return its shape."""

    def seen() -> _Shape | None:
        depsgraph.update()
        return _shape_if(topology, probe.evaluated_get(depsgraph)) if is_current(probe, depsgraph) else None

    for modifier in list(probe.modifiers):
        if modifier.type not in KEEPS_VERTICES | MAY_KEEP_VERTICES:
            probe.modifiers.remove(modifier)
    shape = seen()
    doubtful = [modifier for modifier in probe.modifiers if modifier.show_viewport]
    if shape is not None or not doubtful:
        return shape
    for modifier in doubtful:
        modifier.show_viewport = False
    for modifier in doubtful:
        modifier.show_viewport = True
        if modifier.type in MAY_KEEP_VERTICES and seen() is None:
            modifier.show_viewport = False
    return seen()


def _shape_if(topology: _Topology, evaluated: bpy.types.Object) -> _Shape | None:
    """Return the shape of an evaluated object, if it has the expected vertices."""
    try:
        mesh = evaluated.to_mesh()
        return _shape(mesh) if topology.is_that_of(mesh) else None
    finally:
        evaluated.to_mesh_clear()


def _shape(mesh: bpy.types.Mesh) -> _Shape:
    return _Shape(vertex_positions(mesh), triangle_corners(mesh, "vertices"))


def _has_area(mesh: TriangleMesh) -> bool:
    """Return whether some triangle has an area; usually one of the first has."""
    for some in chunks(len(mesh.faces), 4096):
        a, b, c = mesh.vertices[mesh.faces[some]].swapaxes(0, 1)
        if np.cross(b - a, c - a).any():
            return True
    return False


def _world(obj: bpy.types.Object, shape: _Shape, matrix: NDArray[np.float64]) -> TriangleMesh:
    """Transform a shape to world space, and check that it supports densities."""
    if not len(shape.faces):
        raise InputError("{object} has no faces; choose an object with a surface.", object=obj.name)
    require_finite(obj.name, matrix)
    bad = int((~np.isfinite(shape.vertices)).any(axis=1).sum())
    if bad:
        raise InputError(
            "{object}: {bad} of {count} vertices have coordinates that are not numbers (NaN or infinite); "
            "delete them, or the modifier that makes them.",
            object=obj.name,
            bad=bad,
            count=len(shape.vertices),
        )
    vertices = shape.vertices.astype(np.float64)
    mesh = TriangleMesh.from_arrays(transformed_points(vertices, matrix), shape.faces)
    if not _has_area(mesh):
        raise InputError("The surface of {object} has no area; check its scale in Item > Transform.", object=obj.name)
    return mesh.flipped() if np.linalg.det(matrix[:3, :3]) < 0 else mesh
