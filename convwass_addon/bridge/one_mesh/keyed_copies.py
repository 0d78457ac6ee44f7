# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Copies of meshes for other programs: with their shape keys, armature and place, keyed in every frame."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Matrix

from ..animation_time import returning, show_time
from ..files.borrowed_names import borrowed_names
from ..files.scratch_scene import scratch_animation
from ..keyframes import curves_of, interpolate, use_action
from ..morphs.looks.materials import plain_copy, shows_object_color
from ..objects import is_sheared, take_own_materials, transform_mesh, unsheared_factors
from .limiting_groups import anchor_vertices, apply_key_groups
from .rig_poses import key_matrices, key_poses, rig_poses
from .skinning import armatures, influences


@contextmanager
def keyed_copies(objects: Sequence[bpy.types.Object], frames: range) -> Iterator[KeyedCopies]:
    """Link copies of meshes to a temporary scene, with their shape keys keyed in every frame from 0 on.

    Of its modifiers, each keeps an armature, of which a copy is linked too, with its own animation. All other keys are
    in one action.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        Visible meshes with shape keys.
    frames : range
        The frames of the scene.
    """
    sampled = _sampled_keys(objects, frames)
    with scratch_animation(0, len(frames) - 1) as scene:
        copies = KeyedCopies(scene, bpy.data.actions.new(f"{objects[0].name} Keys"), [], {})
        try:
            for obj, own in zip(objects, sampled, strict=True):
                copies.add(obj, own)
            scene.frame_set(0)
            with borrowed_names(copies.originals):
                yield copies
        finally:
            copies.remove()


@contextmanager
def posed_copies(objects: Sequence[bpy.types.Object], frames: range) -> Iterator[None]:
    """Link copies as `keyed_copies`, with the poses of the armatures keyed, too, for files with a single animation."""
    rigs = [rigged[0].object for rigged in map(armatures, objects) if rigged]
    sampled = rig_poses(rigs, frames)
    with keyed_copies(objects, frames) as copies:
        for original, rig in copies.rigs.items():
            if not sampled[original].is_still:
                key_poses(rig, sampled[original], copies.action)
        copies.scene.frame_set(0)
        yield


def assign_plain_material(
    mesh: bpy.types.Mesh, obj: bpy.types.Object
) -> list[tuple[bpy.types.Material, bpy.types.Material]]:
    """Replace materials that read the color of the object by copies with that color; return these and the originals."""
    made = []
    for place, material in enumerate(mesh.materials):
        if shows_object_color(material):
            made.append((plain_copy(material, tuple(obj.color)), material))
            mesh.materials[place] = made[-1][0]
    return made


@dataclass(frozen=True)
class _Sampled:
    """The names of all shape keys but the first, their values in every frame, and where the object is."""

    names: list[str]
    values: list[list[float]]
    places: list[Matrix]


def _sampled_keys(objects: Sequence[bpy.types.Object], frames: range) -> list[_Sampled]:
    """Read the shape keys of objects with drivers and animation; restores the current frame of the scene."""
    scene = bpy.context.scene
    found = [_Sampled([key.name for key in _mixed_keys(obj)], [], []) for obj in objects]
    with returning(scene):
        for frame in frames:
            show_time(scene, frame)
            depsgraph = bpy.context.evaluated_depsgraph_get()
            for obj, own in zip(objects, found, strict=True):
                evaluated = obj.evaluated_get(depsgraph)
                own.values.append([key.value for key in _mixed_keys(evaluated)])
                own.places.append(evaluated.matrix_world.copy())
    return found


def _mixed_keys(obj: bpy.types.Object) -> list[bpy.types.ShapeKey]:
    """Return all shape keys of an object but the first."""
    return list(obj.data.shape_keys.key_blocks)[1:]


@dataclass(frozen=True)
class KeyedCopies:
    """Copies in a temporary scene.

    Attributes
    ----------
    scene : bpy.types.Scene
        The scene.
    action : bpy.types.Action
        Holds all keys.
    originals : list of (bpy.types.ID, bpy.types.ID)
        Every copy and its original.
    rigs : dict
        Copies of armatures by their originals, which may deform several of the objects.
    """

    scene: bpy.types.Scene
    action: bpy.types.Action
    originals: list[tuple[bpy.types.ID, bpy.types.ID]]
    rigs: dict[bpy.types.Object, bpy.types.Object]

    def add(self, obj: bpy.types.Object, sampled: _Sampled) -> None:
        """Copy an object and key the copy."""
        mesh = obj.data.copy()
        self.originals.append((mesh, obj.data))
        take_own_materials(mesh, obj)
        self.originals.extend(assign_plain_material(mesh, obj))
        copy = bpy.data.objects.new(obj.name, mesh)
        self.originals.append((copy, obj))
        self.scene.collection.objects.link(copy)
        apply_key_groups(copy)
        self._key_values(copy, obj, sampled)
        rigged = armatures(obj)
        if rigged:
            self._deform(copy, obj, rigged[0])
        else:
            _key_places(copy, sampled.places, self.action)
        for block in (mesh.shape_keys, copy):
            interpolate(curves_of(block))

    def remove(self) -> None:
        """Remove everything that was created."""
        made = [copy for copy, _ in self.originals]
        places = [rig.parent for rig in self.rigs.values() if rig.parent is not None]
        bpy.data.batch_remove([own for own in (*made, *places) if isinstance(own, bpy.types.Object)])
        bpy.data.batch_remove(
            [*(own for own, _ in self.originals if not isinstance(own, bpy.types.Object)), self.action]
        )

    def _key_values(self, copy: bpy.types.Object, obj: bpy.types.Object, sampled: _Sampled) -> None:
        """Key the shape keys of a copy."""
        keys = copy.data.shape_keys
        keys.animation_data_clear()
        keys.name = f"{obj.name} Keys"
        use_action(keys, self.action)
        for name, values in zip(sampled.names, zip(*sampled.values, strict=True), strict=True):
            for number, value in enumerate(values):
                keys.key_blocks[name].value = value
                keys.key_blocks[name].keyframe_insert("value", frame=number)

    def _deform(self, copy: bpy.types.Object, obj: bpy.types.Object, modifier: bpy.types.Modifier) -> None:
        """Let a copy of an object's armature deform a copy of the object."""
        original = modifier.object
        rig = self.rigs.get(original) or self._rig(original)
        copy.modifiers.new("Armature", "ARMATURE").object = rig
        # Unlike a location, a rotation and a scale, it may have a shear.
        copy.parent, copy.matrix_parent_inverse = rig, original.matrix_world.inverted() @ obj.matrix_world
        anchor_vertices(copy, rig, influences(obj, modifier, copy.data).ravel())

    def _rig(self, original: bpy.types.Object) -> bpy.types.Object:
        """Link a copy of an armature to the scene.

        If it is sheared, the copy has an Empty as a parent, since files contain locations, rotations and scales.
        """
        rig = self.rigs[original] = original.copy()
        self.originals.append((rig, original))
        rig.data = rig.data.copy()
        self.originals.append((rig.data, original.data))
        world = rig.matrix_world.copy()
        self.scene.collection.objects.link(rig)
        rig.parent = None
        if is_sheared(world):
            rig.parent = bpy.data.objects.new(f"{rig.name} Place", None)
            self.scene.collection.objects.link(rig.parent)
            rig.parent.matrix_basis, rig.matrix_basis = unsheared_factors(world)
            rig.parent_type, rig.matrix_parent_inverse = "OBJECT", Matrix()
        else:
            rig.matrix_world = world
        return rig


def _key_places(copy: bpy.types.Object, places: Sequence[Matrix], action: bpy.types.Action) -> None:
    """Place an object in every frame from 0 on, with keys in an action if it moves; its mesh takes a shear."""
    if any(map(is_sheared, places)):
        transform_mesh(copy.data, places[0])
        # Free of shear if only its parent moves.
        places = [place @ places[0].inverted_safe() for place in places]
    copy.matrix_world = places[0]
    if np.allclose(places, places[0], atol=1e-6):
        return
    use_action(copy, action)
    copy.rotation_mode = "QUATERNION"
    key_matrices(copy, "matrix_world", places)
