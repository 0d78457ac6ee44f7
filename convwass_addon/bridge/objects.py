# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Convert mesh objects of the scene to arrays, and arrays to meshes."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import bpy
import numpy as np
from mathutils import Matrix
from numpy.typing import NDArray

from ..errors import InputError
from ..geometry.algebra.affine import transformed_points
from ..geometry.meshes.mesh import TriangleMesh
from ..geometry.meshes.polygons import Polygons
from .element_values import element_values, triangle_corners, vectors_of, write_floats
from .matrix_checks import is_flattening, require_depth, require_finite
from .mesh_checks import not_a_mesh
from .morphs.looks.frame_attributes import VELOCITY
from .unused_data import removed_on_errors
from .visibility import current_objects, evaluated_object

if TYPE_CHECKING:
    from ..applications.morphs.part_labels import FaceLabels

_PLACES = 17

MESHED = ("MESH", "FONT", "CURVE")
"""Object types that Blender can convert to possibly solid meshes."""

# Relative difference of scales that single precision makes.
_UNEVEN = 1e-5


def triangle_mesh(
    obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, kinds: tuple[str, ...] = ("MESH",)
) -> TriangleMesh:
    """Read an object in world space with modifiers applied.

    The object may be in Edit Mode, hidden, or in a collection that is hidden or excluded from the view layer.

    Parameters
    ----------
    obj : bpy.types.Object
        The original (not evaluated) mesh object.
    depsgraph : bpy.types.Depsgraph
        ``context.evaluated_depsgraph_get()``; updated here.
    kinds : tuple of str
        Allowed object types, such as `MESHED`.

    Returns
    -------
    TriangleMesh
        World space. The orientation of faces is preserved, also under mirroring transforms.

    Raises
    ------
    InputError
        The object is not a mesh, has no faces, a scale of zero, or coordinates that are not finite; the message names
        the object.
    """
    with _evaluated(obj, depsgraph, kinds) as evaluated:
        try:
            return _world_mesh(obj.name, evaluated, evaluated.to_mesh())
        finally:
            evaluated.to_mesh_clear()


@dataclass(frozen=True)
class LabeledMesh:
    """A mesh with labeled parts.

    Attributes
    ----------
    mesh : TriangleMesh
        World space.
    labels : FaceLabels
        The part of every triangle.
    """

    mesh: TriangleMesh
    labels: FaceLabels


def triangle_meshes(objects: Sequence[bpy.types.Object], depsgraph: bpy.types.Depsgraph) -> list[TriangleMesh]:
    """Read objects as `triangle_mesh` does; Blender rebuilds its graph to show hidden ones, here once for all."""
    with current_objects(objects, depsgraph):
        return [triangle_mesh(obj, depsgraph) for obj in objects]


def labeled_mesh(
    obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, kind: Literal["vertex-groups", "materials"]
) -> LabeledMesh:
    """Read an object of a type in `MESHED` as `triangle_mesh` does, with the part of every triangle after modifiers.

    Parameters
    ----------
    obj, depsgraph
        As for `triangle_mesh`.
    kind : "vertex-groups" or "materials"
        What defines the parts.

    Raises
    ------
    InputError
        As for `triangle_mesh`.
    """
    from .face_labels import LABELS

    with _evaluated(obj, depsgraph, MESHED) as evaluated:
        mesh = evaluated_mesh(evaluated, depsgraph)
        try:
            return LabeledMesh(_world_mesh(obj.name, evaluated, mesh), LABELS[kind](evaluated, mesh))
        finally:
            bpy.data.meshes.remove(mesh)


def evaluated_mesh(evaluated: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> bpy.types.Mesh:
    """Return a new mesh of what an evaluated object shows, with all of its attributes."""
    return bpy.data.meshes.new_from_object(evaluated, preserve_all_data_layers=True, depsgraph=depsgraph)


def frozen_copy(
    obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, kinds: tuple[str, ...] = ("MESH",)
) -> bpy.types.Mesh:
    """Create a new mesh from an object in world space with modifiers applied.

    Polygons, materials, UV maps and attributes are kept.

    Parameters
    ----------
    obj, depsgraph, kinds
        As for `triangle_mesh`.

    Returns
    -------
    bpy.types.Mesh
        A data-block without users, named after the object.

    Raises
    ------
    InputError
        As for `triangle_mesh`.
    """
    with _evaluated(obj, depsgraph, kinds) as evaluated:
        checked_matrix(evaluated)
        world = evaluated.matrix_world.copy()
        mesh = evaluated_mesh(evaluated, depsgraph)
        with removed_on_errors([mesh]):
            _check_faces(obj.name, evaluated, mesh)
            checked_vertices(obj.name, mesh)
    mesh.name = obj.name
    take_own_materials(mesh, obj)
    transform_mesh(mesh, world)
    mesh.update()
    return mesh


def world_copy(obj: bpy.types.Object, name: str) -> bpy.types.Object:
    """Create an object at the origin with the mesh of another one in world space, without modifiers.

    Unlike an object without a parent, the mesh can be sheared; see `is_sheared`.

    Parameters
    ----------
    obj : bpy.types.Object
        A mesh object whose world matrix is current; see `update_places`.
    name : str
        Name of the copy.

    Returns
    -------
    bpy.types.Object
        Not linked to a scene, with a mesh of its own and the color of the object.
    """
    copy = bpy.data.objects.new(name, obj.data.copy())
    copy.color = obj.color
    transform_mesh(copy.data, obj.matrix_world)
    return copy


def place_mesh(obj: bpy.types.Object, matrix: Matrix) -> None:
    """Place a new mesh object in the world; what a location, a rotation and a scale cannot express is done to its mesh.

    Parameters
    ----------
    obj : bpy.types.Object
        Without a parent, and with a mesh of its own.
    matrix : Matrix
        The world matrix.
    """
    if is_sheared(matrix):
        transform_mesh(obj.data, matrix.to_3x3().to_4x4())
        obj.location = matrix.translation
    else:
        obj.matrix_world = matrix


def stand(obj: bpy.types.Object, matrix: Matrix) -> list[bpy.types.Object]:
    """Place an object of any type in the world, without its parent.

    Parameters
    ----------
    obj : bpy.types.Object
        An object.
    matrix : Matrix
        The world matrix.

    Returns
    -------
    list of bpy.types.Object
        If the matrix is sheared, a new Empty at the origin, which is not in a scene: the object needs it as a parent.
    """
    obj.parent, obj.parent_type = None, "OBJECT"
    if not is_sheared(matrix):
        obj.matrix_world = matrix
        return []
    obj.parent = bpy.data.objects.new(f"{obj.name} Place", None)
    obj.matrix_parent_inverse, obj.matrix_basis = matrix, Matrix()
    return [obj.parent]


def take_parent(before: bpy.types.Object, after: bpy.types.Object) -> None:
    """Give an object the parent of the one that it replaces, with the same relation to it."""
    if before.parent is None:
        return
    after.parent = before.parent
    after.parent_type = before.parent_type
    if before.parent_type == "BONE":
        after.parent_bone = before.parent_bone
    elif before.parent_type in {"VERTEX", "VERTEX_3"}:
        after.parent_vertices = before.parent_vertices
    after.matrix_parent_inverse = before.matrix_parent_inverse


def is_sheared(matrix: Matrix) -> bool:
    """Return whether no location, rotation and scale give a matrix; objects without a parent have nothing else.

    Turned children of an unevenly scaled parent are sheared.
    """
    difference = np.array(matrix) - np.array(Matrix.LocRotScale(*matrix.decompose()))
    return bool(np.abs(difference).max() > _UNEVEN * np.abs(np.array(matrix)[:3, :3]).max())


def unsheared_factors(matrix: Matrix) -> tuple[Matrix, Matrix]:
    """Return two matrices without shear whose product is a matrix, by its singular value decomposition.

    The second one is a rotation.
    """
    left, scales, right = np.linalg.svd(np.array(matrix.to_3x3(), dtype=np.float64))
    # Mirrored axes are negative scales.
    for axes, last in ((left, (slice(None), 2)), (right, (2, slice(None)))):
        if np.linalg.det(axes) < 0.0:
            axes[last] *= -1.0
            scales[2] *= -1.0
    place = Matrix.Translation(matrix.translation) @ Matrix((left * scales).tolist()).to_4x4()
    return place, Matrix(right.tolist()).to_4x4()


def transform_mesh(mesh: bpy.types.Mesh, matrix: Matrix) -> None:
    """Transform a mesh with its shape keys, its custom normals and its velocity.

    Faces that point outward still do if the matrix mirrors them.

    Parameters
    ----------
    mesh : bpy.types.Mesh
        The mesh.
    matrix : Matrix
        The transform.
    """
    normals = _transformed_normals(mesh, matrix)
    before = _corner_order(mesh) if normals is not None else None
    mesh.transform(matrix, shape_keys=True)
    if matrix.is_negative:
        mesh.flip_normals()
    if normals is not None:
        placed = np.empty_like(normals)
        placed[_corner_order(mesh)] = normals[before]
        mesh.normals_split_custom_set(placed.tolist())
    _transform_velocity(mesh, matrix)


def _transform_velocity(mesh: bpy.types.Mesh, matrix: Matrix) -> None:
    """Transform the velocity of the points of a mesh, if it has one; Blender only transforms the points."""
    velocity = mesh.attributes.get(VELOCITY)
    if velocity is not None and velocity.data_type == "FLOAT_VECTOR":
        turned = element_values(velocity.data, "vector", 3) @ np.array(matrix.to_3x3().transposed(), dtype=np.float32)
        write_floats(velocity.data, "vector", turned)


def _transformed_normals(mesh: bpy.types.Mesh, matrix: Matrix) -> np.ndarray | None:
    """Return the normals of the corners after a transform, (l, 3), if Blender would not keep custom ones.

    It stores them relative to the surface, which only turns and scales evenly with them.
    """
    linear = np.array(matrix, dtype=np.float64)[:3, :3]
    lengths = np.linalg.svd(linear, compute_uv=False)
    is_even = lengths[-1] >= (1.0 - _UNEVEN) * lengths[0] and not matrix.is_negative
    if is_even or is_flattening(linear) or not mesh.has_custom_normals:
        return None
    normals = element_values(mesh.corner_normals, "vector", 3)
    turned = normals @ np.linalg.inv(linear)
    return turned / np.linalg.norm(turned, axis=1, keepdims=True)


def _corner_order(mesh: bpy.types.Mesh) -> np.ndarray:
    """Return the corners of a mesh by face and vertex, an order that flipping faces keeps, (l,)."""
    counts = element_values(mesh.polygons, "loop_total", kind=np.int32)
    vertices = element_values(mesh.loops, "vertex_index", kind=np.int32)
    return np.lexsort((vertices, np.repeat(np.arange(len(counts)), counts)))


def take_own_materials(mesh: bpy.types.Mesh, obj: bpy.types.Object) -> None:
    """Give a copy of an object's mesh the materials that the object has in place of those of its mesh."""
    for place, slot in enumerate(obj.material_slots[: len(mesh.materials)]):
        if slot.link == "OBJECT":
            mesh.materials[place] = slot.material


def use_existing_slots(mesh: bpy.types.Mesh) -> None:
    """Give the faces of slots that a mesh does not have its last one, as renders show them; nodes take the first."""
    slots, last = element_values(mesh.polygons, "material_index", kind=np.int32), max(len(mesh.materials) - 1, 0)
    if len(slots) and slots.max() > last:
        mesh.polygons.foreach_set("material_index", np.minimum(slots, last))


def write_mesh(mesh_data: bpy.types.Mesh, mesh: TriangleMesh, polygons: Polygons | None = None) -> None:
    """Replace the geometry of a mesh, with smooth shading.

    Parameters
    ----------
    mesh_data : bpy.types.Mesh
        Its materials are kept.
    mesh : TriangleMesh
        In the local space of the objects that use `mesh_data`.
    polygons : Polygons, optional
        Faces to use instead of triangles.
    """
    polygons = polygons or Polygons.of_triangles(mesh.faces)
    # Blender would number the edges in the order of a hash table; sorted ones compress better.
    edges = polygons.edges
    mesh_data.clear_geometry()
    mesh_data.vertices.add(len(mesh.vertices))
    mesh_data.edges.add(len(edges.vertices))
    mesh_data.loops.add(len(polygons.corners))
    mesh_data.polygons.add(len(polygons.starts))
    # Only contiguous arrays of exactly these types are copied in one operation; others are copied element by element.
    write_floats(mesh_data.vertices, "co", _short(mesh.vertices))
    mesh_data.loops.foreach_set("vertex_index", np.ascontiguousarray(polygons.corners, dtype=np.int32))
    mesh_data.loops.foreach_set("edge_index", np.ascontiguousarray(edges.of_corners, dtype=np.int32))
    mesh_data.edges.foreach_set("vertices", np.ascontiguousarray(edges.vertices, dtype=np.int32).ravel())
    mesh_data.polygons.foreach_set("loop_start", np.ascontiguousarray(polygons.starts, dtype=np.int32))
    mesh_data.shade_smooth()
    mesh_data.update()


def write_triangles(mesh: bpy.types.Mesh, triangles: TriangleMesh) -> None:
    """Replace the geometry of a mesh as fast as possible; its materials are kept.

    Attributes take arrays at a third of the time of the lists of vertices and corners (docs/performance, "Live
    blends").
    """
    count = len(triangles.faces)
    mesh.clear_geometry()
    mesh.vertices.add(len(triangles.vertices))
    mesh.loops.add(3 * count)
    mesh.polygons.add(count)
    positions = np.ascontiguousarray(triangles.vertices, dtype=np.float32)
    mesh.attributes["position"].data.foreach_set("vector", positions.ravel())
    corners = np.ascontiguousarray(triangles.faces, dtype=np.int32)
    mesh.attributes[".corner_vert"].data.foreach_set("value", corners.ravel())
    mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * count, 3, dtype=np.int32))
    mesh.update(calc_edges=True)


def _short(vertices: np.ndarray) -> np.ndarray:
    """Round points to 17 binary digits of their extent: finer than any grid, and files compress better."""
    extent = float(np.ptp(vertices, axis=0).max()) if len(vertices) else 0.0
    if not extent > 0.0:
        return vertices
    step = 2.0 ** (np.floor(np.log2(extent)) - _PLACES)
    return np.rint(np.asarray(vertices) / step) * step


def _evaluated(
    obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, kinds: tuple[str, ...]
) -> AbstractContextManager[bpy.types.Object]:
    """Provide the evaluated object if its type is allowed."""
    if obj.type not in kinds:
        raise not_a_mesh(obj)
    return evaluated_object(obj, depsgraph)


def checked_matrix(evaluated: bpy.types.Object) -> np.ndarray:
    """Return the world matrix of an evaluated object, (4, 4) float64; raises InputError if it flattens the object."""
    matrix = np.array(evaluated.matrix_world, dtype=np.float64)
    require_finite(evaluated.name, matrix)
    require_depth(evaluated.name, matrix)
    return matrix


def _world_mesh(name: str, evaluated: bpy.types.Object, mesh: bpy.types.Mesh) -> TriangleMesh:
    """Check an evaluated object and its mesh, and transform the mesh to world space."""
    matrix = checked_matrix(evaluated)
    _check_faces(name, evaluated, mesh)
    vertices = checked_vertices(name, mesh)
    result = TriangleMesh.from_arrays(transformed_points(vertices, matrix), triangle_corners(mesh, "vertices"))
    return result.flipped() if np.linalg.det(matrix[:3, :3]) < 0 else result


def checked_vertices(name: str, mesh: bpy.types.Mesh) -> NDArray[np.float64]:
    """Return the coordinates of a mesh, (n, 3); raises InputError with this name if some are not finite."""
    try:
        return TriangleMesh.from_arrays(vectors_of(mesh.vertices), np.empty((0, 3), np.int64)).vertices
    except InputError as error:
        raise InputError(
            "{name}: {reason} Delete those vertices, or the modifier that makes them.", name=name, reason=error.sentence
        ) from error


def _check_faces(name: str, evaluated: bpy.types.Object, mesh: bpy.types.Mesh) -> None:
    """Raise InputError if the mesh of an evaluated object has no faces."""
    if len(mesh.polygons):
        return
    if len(mesh.edges):
        raise InputError(
            "{name} has edges but no faces, so it has no volume; give it thickness, for example with a Skin modifier.",
            name=name,
        )
    if len(mesh.vertices):
        raise InputError(
            "{name} has points but no faces, so it has no volume; choose an object with a surface.", name=name
        )
    if evaluated.evaluated_geometry().instances_pointcloud() is not None:
        raise InputError(
            "{name} shows instances only and has no faces of its own; add the node Realize Instances.", name=name
        )
    raise InputError("{name} is an empty mesh; choose an object with a surface.", name=name)
