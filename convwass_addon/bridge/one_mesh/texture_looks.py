# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The surfaces between which textures are baked: the one mesh at each of its shapes, and the shapes themselves.

An object with shape keys remembers the shapes they lead to, and where these were laid to match it.
"""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Matrix
from numpy.typing import NDArray

from ...errors import ConvwassError, InputError
from ...geometry.algebra.affine import transformed_points
from ...geometry.meshes.closest_points import ClosestPointFinder
from ..element_values import element_values, write_floats
from ..handles import Handle
from ..morphs.bake import assign_default_material
from ..object_values import ObjectValues
from ..objects import evaluated_mesh, stand, take_own_materials, triangle_mesh
from ..scene_values import SceneValues
from ..unused_data import remove_if_unused, removed_on_errors
from ..visibility import evaluated_object
from .limiting_groups import limited_moves
from .records import SHAPES_KEY, key_records, recorded_keys

# The mesh must end within this multiple of the distance in its record, plus a share of the shape's diagonal.
_SLACK, _LEAST = 3.0, 0.01
# Points at which this is checked.
_CHECKED = 2000


@dataclass(frozen=True)
class Surface:
    """A frozen object.

    Attributes
    ----------
    mesh : Handle
        Without users, in local space.
    world : (4, 4) float64
        From local to world space.
    values : ObjectValues
        What its materials read of the object.
    """

    mesh: Handle
    world: NDArray[np.float64]
    values: ObjectValues

    def found(self) -> bpy.types.Mesh:
        """Return the mesh; raises ConvwassError if it was removed by undo."""
        return self.mesh.living(ConvwassError("The copies of the shapes were removed during the baking; start again."))

    def object_in(self, scene: bpy.types.Scene, name: str) -> bpy.types.Object:
        """Link an object with a copy of the mesh to a scene; it has an Empty as a parent if it is sheared.

        Raises
        ------
        ConvwassError
            The mesh was removed by undo.
        """
        obj = bpy.data.objects.new(name, self.found().copy())
        self.values.write_to(obj)
        stand(obj, Matrix(self.world))
        scene.collection.objects.link(obj)
        return obj


@dataclass(frozen=True)
class Look:
    """A shape whose look is baked.

    Attributes
    ----------
    name : str
        Name of the shape.
    slider : str or None
        The slider that leads to it; None for the undeformed mesh.
    onto : Surface
        The mesh in this shape.
    shape : Surface or None
        The shape; None for the undeformed mesh, which is baked from itself.
    reach : float
        Typical distance of the two, scene units.
    scene : SceneValues
        What the materials of the shape read of the scene.
    """

    name: str
    slider: str | None
    onto: Surface
    shape: Surface | None
    reach: float
    scene: SceneValues

    @property
    def source(self) -> Surface:
        """The surface that has the look."""
        return self.shape or self.onto

    def discard(self) -> None:
        """Remove the copies."""
        remove_if_unused(surface.mesh.find() for surface in (self.onto, self.shape) if surface is not None)


def remember_shape(obj: bpy.types.Object, slider: str, shape: bpy.types.Object, placement: NDArray[np.float64]) -> None:
    """Store the shape that a slider of an object leads to.

    Parameters
    ----------
    obj : bpy.types.Object
        An object with shape keys.
    slider : str
        Name of a slider.
    shape : bpy.types.Object
        The shape.
    placement : (4, 4) float64
        The transform from where it is in the scene to where the mesh reaches it while the object is where it is now.
    """
    known = obj[SHAPES_KEY].to_dict() if SHAPES_KEY in obj else {}
    placed, own = (np.array(matrix, dtype=np.float64).ravel().tolist() for matrix in (placement, obj.matrix_world))
    obj[SHAPES_KEY] = {**known, slider: {"shape": shape, "placement": placed, "object": own}}


def remembered_shapes(obj: bpy.types.Object) -> dict[str, tuple[bpy.types.Object, NDArray[np.float64]]]:
    """Return the shapes that sliders of an object lead to, with their placements where the object is now, by slider.

    Deleted shapes are left out.
    """
    known = obj[SHAPES_KEY].to_dict() if SHAPES_KEY in obj else {}
    now = np.array(obj.matrix_world, dtype=np.float64)
    found = {}
    for slider, stored in known.items():
        placed = np.array(stored["placement"], dtype=np.float64).reshape(4, 4)
        # Earlier versions did not store where the object was.
        before = np.array(stored["object"], dtype=np.float64).reshape(4, 4) if "object" in stored else now
        if stored.get("shape") is not None:
            found[slider] = (stored["shape"], now @ np.linalg.solve(before, placed))
    return found


def start_look(obj: bpy.types.Object, prepared: bpy.types.Mesh, made: str) -> Look:
    """Freeze the undeformed mesh with its own look.

    Parameters
    ----------
    obj, prepared
        As for :func:`end_look`.
    made : str
        Name of the UV map that was made for the textures; empty if it is one of the mesh itself.
    """
    onto = _posed(obj, prepared, None)
    layers = onto.found().uv_layers
    if layers.keys() == [made]:
        # Textures that name no UV map are at (0, 0) everywhere, as on a mesh that has none.
        layers.new(do_init=False).active_render = True
        layers.active = layers[made]
    return Look(obj.name, None, onto, None, 0.0, _scene_values(onto.found()))


def end_look(obj: bpy.types.Object, slider: str, prepared: bpy.types.Mesh) -> Look:
    """Freeze the mesh where a slider leads to, and the shape there.

    Parameters
    ----------
    obj : bpy.types.Object
        An object with shape keys.
    slider : str
        Name of a slider.
    prepared : bpy.types.Mesh
        A copy of its mesh without shape keys and with the UV map for the textures.

    Raises
    ------
    InputError
        The shape was deleted, or the mesh does not reach it.
    """
    shape, placement = remembered_shapes(obj).get(slider, (None, None))
    if shape is None:
        raise InputError("The shape of {slider} is not in this file; bake the shape keys again.", slider=slider)
    record = next(own for own in key_records(obj) if own["name"] == slider)
    key = obj.data.shape_keys.key_blocks.get(recorded_keys(record)[-1])
    if key is None:
        raise InputError("The shape key of {slider} was removed or renamed; bake it again.", slider=slider)
    positions = element_values(key.data, "co", 3) + _own_moves(obj)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    there = triangle_mesh(shape, depsgraph)
    onto = _posed(obj, prepared, positions)
    points = transformed_points(there.vertices, placement)
    diagonal = float(np.linalg.norm(np.ptp(points, axis=0)))
    with removed_on_errors([onto.mesh.find()]):
        _check_arrival(onto, points[there.faces], slider, diagonal, float(record.get("distance_95", 0.0)))
        with evaluated_object(shape, depsgraph) as evaluated:
            world = placement @ np.array(evaluated.matrix_world, dtype=np.float64)
            mesh = evaluated_mesh(evaluated, depsgraph)
    take_own_materials(mesh, shape)
    assign_default_material(mesh)
    reach = float(record.get("distance_95", 0.0)) * diagonal
    values = ObjectValues.of(shape, mesh.materials)
    return Look(slider, slider, onto, Surface(Handle.of("meshes", mesh), world, values), reach, _scene_values(mesh))


def _own_moves(obj: bpy.types.Object) -> NDArray[np.float32]:
    """Return how shape keys that no slider drives move the vertices of an object now, (n, 3).

    The last key of a slider leads to its shape from there.
    """
    driven = {name for record in key_records(obj) for name in recorded_keys(record)}
    reference, *keys = obj.data.shape_keys.key_blocks
    moves = np.zeros((len(reference.data), 3), np.float32)
    for key in keys:
        if key.name not in driven and not key.mute:
            moves += key.value * limited_moves(obj, key)
    return moves


def _scene_values(mesh: bpy.types.Mesh) -> SceneValues:
    """Return what the materials of a mesh read of the current scene now."""
    return SceneValues.of(bpy.context.scene, bpy.context.view_layer, mesh.materials)


def _check_arrival(
    onto: Surface, triangles: NDArray[np.float64], slider: str, diagonal: float, distance: float
) -> None:
    """Raise InputError if a mesh is not at its shape, such as in another pose."""
    mesh = onto.mesh.find()
    points = element_values(mesh.vertices, "co", 3)
    every = max(1, len(mesh.vertices) // _CHECKED)
    sample = transformed_points(points[::every].astype(np.float64), onto.world)
    found = ClosestPointFinder(triangles).find(sample)
    if np.quantile(found.distances, 0.9) > (_SLACK * distance + _LEAST) * diagonal:
        raise InputError(
            "The mesh does not reach {slider} in its current pose; go to the frame in which its shape keys were "
            "baked, and leave the shape where it was.",
            slider=slider,
        )


def _posed(obj: bpy.types.Object, prepared: bpy.types.Mesh, positions: NDArray[np.float32] | None) -> Surface:
    """Freeze an object with other positions of its vertices, modifiers applied."""
    mesh = prepared.copy()
    if positions is not None:
        write_floats(mesh.vertices, "co", positions)
    copy = obj.copy()
    copy.animation_data_clear()
    copy.data = mesh
    bpy.context.scene.collection.objects.link(copy)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    try:
        with evaluated_object(copy, depsgraph) as evaluated:
            frozen = evaluated_mesh(evaluated, depsgraph)
            world = np.array(evaluated.matrix_world, dtype=np.float64)
        take_own_materials(frozen, obj)
    finally:
        bpy.data.objects.remove(copy)
        bpy.data.meshes.remove(mesh)
    return Surface(Handle.of("meshes", frozen), world, ObjectValues.of(obj, frozen.materials))
