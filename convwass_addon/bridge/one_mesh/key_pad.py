# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A pad whose handle drives the sliders of a mesh with shape keys: a triangle for two targets, a square for three."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import bpy
import numpy as np
from mathutils import Vector

from ...errors import InputError
from ..keyframes import driver_targets, drivers_of, remove_curve
from ..mesh_checks import writable_mesh
from ..morphs.players.blend_pad import GAP, SIDE, TEXT
from ..morphs.removal import remove_objects
from ..pad_handles import OUTLINES, drive_by_handle, pad_handle, pad_labels, pad_lines
from .records import key_records
from .shape_keys import slider_path

PAD_KEY = "convwass_key_pad"
"""Custom property of a pad and of its handle and labels."""

# Data-blocks that show objects without using them for anything.
_PLACES = (bpy.types.Collection, bpy.types.Scene, bpy.types.Screen)

# Corners of the pads in X and Z, relative to the side; the first one is the original mesh.
_TRIANGLE = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, math.sqrt(0.75)]])
_SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])


def make_key_pad(obj: bpy.types.Object) -> bpy.types.Object:
    """Make an Empty on a pad drive the sliders of an object, and return it; their keyframes are removed.

    The handle of a pad that drives all sliders already is returned, and one that drives some of them is replaced.

    Drivers are simple expressions, so the file does not need the add-on. Outside of the pad, the weights of its edge
    are used.

    Parameters
    ----------
    obj : bpy.types.Object
        Has shape keys to two or three other shapes.

    Raises
    ------
    InputError
        Any other number of shapes, or the object is linked from another file.
    """
    writable_mesh(obj)
    names = [record["name"] for record in key_records(obj)]
    if len(names) not in (2, 3):
        raise InputError("A pad needs two or three other shapes; {name} has {count}.", name=obj.name, count=len(names))
    before = pads_of(obj)
    known = _driving_handle(obj, names)
    if known is not None:
        return known
    size = max(obj.dimensions)
    side = SIDE * size
    corners = _TRIANGLE if len(names) == 2 else _SQUARE
    points = side * np.stack([corners[:, 0], np.zeros(len(corners)), corners[:, 1]], axis=1)
    pad = pad_lines(f"{obj.name} Pad", points, OUTLINES[len(points)])
    middle = np.array(obj.matrix_world @ _center(obj))
    pad.location = middle - np.array([side + (GAP + 0.5) * size, 0.0, side / 2.0])
    handle = pad_handle("Key Handle", 0.06 * side, points, pad)
    for made in (pad, handle, *pad_labels((obj.name, *names), points, TEXT * side, pad)):
        made[PAD_KEY] = True
        bpy.context.scene.collection.objects.link(made)
    for name, expression in zip(names, _expressions(len(names), side), strict=True):
        _drive(obj, name, handle, expression)
    remove_idle_pads(before)
    return handle


def foreign_drivers(obj: bpy.types.Object) -> list[str]:
    """Return the sliders of an object that drivers set which are not those of a pad, whose handle may be deleted."""
    read = _read_by_drivers(obj, [record["name"] for record in key_records(obj)])
    return [
        name
        for name, blocks in read.items()
        if blocks != {None} and not any(own is not None and PAD_KEY in own for own in blocks)
    ]


def _driving_handle(obj: bpy.types.Object, names: Sequence[str]) -> bpy.types.Object | None:
    """Return the handle of a pad that drives all sliders of an object, if there is one."""
    read = _read_by_drivers(obj, names)
    shared = set.intersection(*read.values()) if len(read) == len(names) else set()
    return next((own for own in shared if own is not None and PAD_KEY in own and own.parent is not None), None)


def _read_by_drivers(obj: bpy.types.Object, names: Sequence[str]) -> dict[str, set[bpy.types.ID | None]]:
    """Return what the drivers of sliders of an object read, for those of the sliders that have one."""
    found = {
        curve.data_path: {target.id for own in curve.driver.variables for target in own.targets}
        for curve in drivers_of(obj)
    }
    return {name: found[slider_path(name)] for name in names if slider_path(name) in found}


def pads_of(obj: bpy.types.Object) -> list[bpy.types.Object]:
    """Return the pads whose handles drive an object, and those of it whose handle was deleted.

    Those of earlier versions are not recognized.
    """
    blocks = {target.id for target in driver_targets(obj)}
    handles = (block for block in blocks if isinstance(block, bpy.types.Object) and PAD_KEY in block)
    parents = dict.fromkeys(handle.parent for handle in handles if handle.parent is not None)
    names = {obj.name, *(record["name"] for record in key_records(obj))}
    left = [own for own in bpy.data.objects if PAD_KEY in own and own.type == "MESH" and _is_left_of(own, names)]
    return [*(parent for parent in parents if PAD_KEY in parent), *left]


def _is_left_of(pad: bpy.types.Object, names: set[str]) -> bool:
    """Return whether a pad has no handle, and labels for some shapes."""
    parts = [child for child in pad.children if PAD_KEY in child]
    return {part.type for part in parts} == {"FONT"} and {part.data.body for part in parts} == names


def remove_idle_pads(pads: Iterable[bpy.types.Object]) -> None:
    """Remove pads, with handles and labels, that neither drive anything nor are used otherwise."""
    for pad in pads:
        parts = [pad, *(child for child in pad.children if PAD_KEY in child)]
        users = set().union(*bpy.data.user_map(subset=parts).values()).difference(parts)
        if all(isinstance(user, _PLACES) for user in users):
            remove_objects(parts)


def _expressions(count: int, side: float) -> list[str]:
    """Return the sliders as functions of x and z, the position of the handle on the pad."""
    if count == 2:
        height = _TRIANGLE[2, 1] * side
        across, up = f"max(0, x / {side:.6g} - z / {2.0 * height:.6g})", f"max(0, z / {height:.6g})"
        return [f"{own} / max(1, {across} + {up})" for own in (across, up)]
    across, up = f"min(1, max(0, x / {side:.6g}))", f"min(1, max(0, z / {side:.6g}))"
    return [f"{across} * (1 - {up})", f"(1 - {across}) * {up}", f"{across} * {up}"]


def _drive(obj: bpy.types.Object, slider: str, handle: bpy.types.Object, expression: str) -> None:
    path = slider_path(slider)
    obj.driver_remove(path)
    # Keyframes of a driven property would have no effect.
    remove_curve(obj, path)
    drive_by_handle(obj.driver_add(path).driver, handle, expression)


def _center(obj: bpy.types.Object) -> Vector:
    return sum((Vector(corner) for corner in obj.bound_box), Vector()) / 8.0
