# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw docs/pictures/soft_maps.jpg, the weights of a horse on a cow: ``python3 run.py python docs/soft_maps.py``.

From the left: a horse, and a cow with its colors, transferred by a soft map from sixteen pairs; the cow bound to its
own bones with the horse's weights, grazing; the same by Blender's Data Transfer from the nearest point of the
aligned animals; and both with a shape key of humps that was sculpted on the horse.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import bpy
import numpy as np
from mathutils import Euler
from numpy.typing import NDArray
from photographs import color_material, photograph_row, sample_shape

import convwass_addon
from convwass_addon.bridge.element_values import element_values
from convwass_addon.bridge.studio.framing import View
from convwass_addon.bridge.studio.rendered_scene import Studio

_STEP = 2.15
_SIZE = (2800, 540)
_MAP = "Soft Map"

Place = tuple[float, float, float]


@dataclass(frozen=True)
class Animal:
    """One of the two animals, in the coordinates in which it was sculpted.

    Attributes
    ----------
    name : str
        Name of its file.
    scale, offset : float
        Conversion to the coordinates of the file: scale * (x - offset, y, z).
    places : list of (float, float, float)
        Nose, ears, hooves, knees, hocks, root and tip of the tail, chest, belly and back; left before right.
    spine, neck, tail : list of (float, float, float)
        Joints, from the hips to the chest, from the chest to the muzzle, and from the hips to the tail's tip.
    legs : dict of str to list of (float, float, float)
        Joints from the top, by the name of the leg.
    """

    name: str
    scale: float
    offset: float
    places: list[Place]
    spine: list[Place]
    neck: list[Place]
    tail: list[Place]
    legs: dict[str, list[Place]]

    def placed(self, points: list[Place]) -> NDArray[np.float64]:
        """Return points in the coordinates of the file, (n, 3)."""
        return self.scale * (np.array(points, float) - [self.offset, 0.0, 0.0])

    def chains(self) -> dict[str, list[Place]]:
        """Return all chains of joints by name; the first one is the root."""
        return {"spine": self.spine, "neck": self.neck, "tail": self.tail, **self.legs}


# fmt: off
HORSE = Animal(
    "horse", 0.853, -0.03,
    [(1.12, 0, 1.46), (0.79, 0.085, 2.13), (0.79, -0.085, 2.13), (0.52, 0.14, 0), (0.54, -0.14, 0.33),
     (-0.42, 0.15, 0), (-0.66, -0.15, 0), (0.55, 0.14, 0.49), (0.9, -0.14, 0.76), (-0.66, 0.15, 0.53),
     (-0.82, -0.15, 0.56), (-0.62, 0, 1.38), (-1.2, 0, 0.7), (0.66, 0, 1.1), (0, 0, 0.88), (0, 0, 1.38)],
    spine=[(-0.5, 0, 1.22), (-0.05, 0, 1.15), (0.4, 0, 1.18)],
    neck=[(0.4, 0, 1.18), (0.57, 0, 1.48), (0.74, 0, 1.8), (1.06, 0, 1.49)],
    tail=[(-0.5, 0, 1.22), (-0.8, 0, 1.38), (-0.92, 0, 1.1), (-1.05, 0, 0.7)],
    legs={
        "fore.L": [(0.42, 0.13, 1.02), (0.42, 0.14, 0.76), (0.45, 0.14, 0.49), (0.45, 0.14, 0.16), (0.52, 0.14, 0.03)],
        "fore.R": [(0.44, -0.13, 1.02), (0.56, -0.14, 0.8), (0.81, -0.14, 0.73), (0.69, -0.14, 0.44),
                   (0.56, -0.14, 0.36)],
        "hind.L": [(-0.45, 0.13, 1.08), (-0.36, 0.15, 0.8), (-0.56, 0.15, 0.53), (-0.49, 0.15, 0.16),
                   (-0.42, 0.15, 0.03)],
        "hind.R": [(-0.47, -0.13, 1.08), (-0.46, -0.15, 0.8), (-0.72, -0.15, 0.56), (-0.73, -0.15, 0.16),
                   (-0.66, -0.15, 0.03)],
    },
)
COW = Animal(
    "cow", 0.847, 0.15,
    [(1.32, 0, 1.15), (0.83, 0.34, 1.46), (0.83, -0.34, 1.46), (0.56, 0.17, 0), (0.56, -0.17, 0),
     (-0.57, 0.17, 0), (-0.57, -0.17, 0), (0.62, 0.17, 0.46), (0.62, -0.17, 0.46), (-0.76, 0.17, 0.52),
     (-0.76, -0.17, 0.52), (-0.86, 0, 1.38), (-0.99, 0, 0.44), (0.78, 0, 1.05), (0, 0, 0.73), (0, 0, 1.39)],
    spine=[(-0.6, 0, 1.18), (-0.05, 0, 1.1), (0.5, 0, 1.14)],
    neck=[(0.5, 0, 1.14), (0.7, 0, 1.32), (0.92, 0, 1.5), (1.22, 0, 1.17)],
    tail=[(-0.6, 0, 1.18), (-0.92, 0, 1.26), (-0.97, 0, 0.95), (-0.98, 0, 0.55)],
    legs={
        f"{leg}.{side}": [(x, sign * y, z) for x, y, z in joints]
        for side, sign in (("L", 1), ("R", -1))
        for leg, joints in {
            "fore": [(0.5, 0.15, 1.0), (0.5, 0.17, 0.72), (0.52, 0.17, 0.46), (0.52, 0.17, 0.13), (0.56, 0.17, 0.02)],
            "hind": [(-0.58, 0.15, 1.08), (-0.5, 0.17, 0.76), (-0.66, 0.17, 0.52), (-0.61, 0.17, 0.13),
                     (-0.57, 0.17, 0.02)],
        }.items()
    },
)
# fmt: on
# Pose of the cow: rotations of its bones about the transverse axis, in degrees.
_GRAZING = {
    "neck.1": 35.0,
    "neck.2": 25.0,
    "neck.3": -10.0,
    "fore.R.1": -40.0,
    "fore.R.2": 75.0,
    "hind.L.1": -22.0,
    "hind.L.2": 18.0,
    "tail.2": -25.0,
    "tail.3": -35.0,
}


def main() -> None:
    """Create all objects, and render them in a row."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    convwass_addon.register()
    horse, cow = (_read(animal) for animal in (HORSE, COW))
    rig, _ = _rig(HORSE), _keyed(horse)
    _bind(horse, rig, "ARMATURE_AUTO")
    _map(horse, cow)
    shown = [_grazing(_copied(cow), _by_map), _grazing(_copied(cow), _by_nearest)]
    shown += [_with_key(_copied(animal)) for animal in (horse, cow)]
    _render([*_colored(horse, cow), *shown])


def _read(animal: Animal) -> bpy.types.Object:
    obj = sample_shape(animal.name)
    obj.data.shade_smooth()
    return obj


def _points(obj: bpy.types.Object) -> NDArray[np.float64]:
    return element_values(obj.data.vertices, "co", 3).astype(float)


def _rig(animal: Animal) -> bpy.types.Object:
    """Return an armature with a bone between every two joints."""
    rig = bpy.data.objects.new(f"{animal.name} bones", bpy.data.armatures.new(animal.name))
    bpy.context.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    bones = rig.data.edit_bones
    for chain, joints in animal.chains().items():
        places = animal.placed(joints)
        for number, (head, tail) in enumerate(pairwise(places), start=1):
            bone = bones.new(f"{chain}.{number}")
            bone.head, bone.tail = head, tail
            bone.align_roll((0.0, 1.0, 0.0))
            at_hips = chain == "tail" or chain.startswith("hind")
            before = f"{chain}.{number - 1}" if number > 1 else f"spine.{1 if at_hips else 2}"
            if chain != "spine" or number > 1:
                bone.parent = bones[before]
    bpy.ops.object.mode_set(mode="OBJECT")
    return rig


def _bind(obj: bpy.types.Object, rig: bpy.types.Object, kind: str) -> None:
    with bpy.context.temp_override(
        object=rig, active_object=rig, selected_objects=[obj, rig], selected_editable_objects=[obj, rig]
    ):
        bpy.ops.object.parent_set(type=kind)


def _keyed(horse: bpy.types.Object) -> None:
    """Add a shape key of two humps to the horse."""
    horse.shape_key_add(name="Basis")
    key = horse.shape_key_add(name="Humps")
    key.value = 0.0
    points = _points(horse)
    share = sum(
        np.exp(-(((points - middle) / [0.1, 0.13, 0.13]) ** 2).sum(axis=1))
        for middle in HORSE.placed([(-0.36, 0, 1.42), (-0.04, 0, 1.37)])
    )
    raised = points + share[:, None] * [0.0, 0.0, 0.24]
    key.data.foreach_set("co", raised.astype(np.float32).ravel())


def _map(horse: bpy.types.Object, cow: bpy.types.Object) -> None:
    own = bpy.context.scene.convwass_soft_map
    own.source, own.target = horse, cow
    wanted = [animal.placed(animal.places) for animal in (HORSE, COW)]
    for first, second in zip(*wanted, strict=True):
        vertices = [int(np.argmin(((_points(obj) - p) ** 2).sum(axis=1))) for obj, p in ((horse, first), (cow, second))]
        bpy.ops.convwass.add_map_pair(source_vertex=vertices[0], target_vertex=vertices[1])
    bpy.ops.convwass.compute_soft_map()
    bpy.ops.convwass.transfer_by_map(what={"GROUPS", "KEYS"})
    bpy.ops.convwass.show_soft_map()


def _colored(horse: bpy.types.Object, cow: bpy.types.Object) -> list[bpy.types.Object]:
    material = color_material(_MAP, _MAP)
    for obj in (horse, cow):
        obj.data.materials.append(material)
    return [horse, cow]


def _copied(obj: bpy.types.Object) -> bpy.types.Object:
    copy = obj.copy()
    copy.data = obj.data.copy()
    copy.data.materials.clear()
    bpy.context.collection.objects.link(copy)
    return copy


def _by_map(cow: bpy.types.Object) -> None:
    """Keep the weights transferred along the map."""


def _by_nearest(cow: bpy.types.Object) -> None:
    """Take the weights of the nearest point of the horse instead, as Data Transfer does."""
    cow.vertex_groups.clear()
    modifier = cow.modifiers.new("Nearest", "DATA_TRANSFER")
    modifier.object = bpy.context.scene.convwass_soft_map.source
    modifier.use_vert_data = True
    modifier.data_types_verts = {"VGROUP_WEIGHTS"}
    modifier.vert_mapping = "POLYINTERP_NEAREST"
    with bpy.context.temp_override(object=cow, active_object=cow):
        bpy.ops.object.datalayout_transfer(modifier=modifier.name)
        bpy.ops.object.modifier_apply(modifier=modifier.name)


def _grazing(cow: bpy.types.Object, weigh) -> bpy.types.Object:
    """Bind the cow to its own bones with the given weights, and let it graze."""
    cow.shape_key_clear()
    weigh(cow)
    rig = _rig(COW)
    _bind(cow, rig, "ARMATURE")
    for name, degrees in _GRAZING.items():
        bone = rig.pose.bones[name]
        bone.rotation_mode = "XYZ"
        across = bone.bone.matrix_local.to_3x3().inverted() @ Euler((0.0, math.radians(degrees), 0.0)).to_matrix()
        bone.rotation_euler = (across @ bone.bone.matrix_local.to_3x3()).to_euler()
    bpy.context.view_layer.update()
    return _as_seen(cow)


def _with_key(animal: bpy.types.Object) -> bpy.types.Object:
    animal.data.shape_keys.key_blocks["Humps"].value = 1.0
    return _as_seen(animal)


def _as_seen(obj: bpy.types.Object) -> bpy.types.Object:
    """Return a copy with the evaluated mesh, independent of bones."""
    seen = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    copy = bpy.data.objects.new(obj.name, bpy.data.meshes.new_from_object(seen))
    copy.matrix_world = obj.matrix_world
    bpy.context.collection.objects.link(copy)
    return copy


def _render(objects: list[bpy.types.Object]) -> None:
    view = View(-math.pi / 2 + math.radians(28.0), math.radians(13.0))
    with Studio() as studio:
        shown = [studio.show(obj, tuple(_STEP * column * view.axes[0])) for column, obj in enumerate(objects)]
        photograph_row(studio, shown, view, _STEP, _SIZE, "soft_maps")


if __name__ == "__main__":
    main()
