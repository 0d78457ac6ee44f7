# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What bakes have made: frames, players, pads, objects that read files, and meshes with shape keys."""

from __future__ import annotations

import bpy

from ...errors import ConvwassError
from ..linked_data import is_linked
from ..one_mesh.baked_keys import baked_keys
from .disk.disk_output import read_morph
from .stand_ins import shown_morph
from .stored import FRAMES_KEY, MORPH_KEY, WEIGHTS_KEY, stored_morph


def bake_of(obj: bpy.types.Object) -> bpy.types.Collection | bpy.types.Object | None:
    """Return what stores the bake that has made an object: a morph, or an object with shape keys; or None."""
    return baked_keys(obj) or shown_morph(obj) or read_morph(obj) or _morph_of_frame(obj)


def baked_from(bake: bpy.types.Collection | bpy.types.Object) -> list[bpy.types.Object]:
    """Return the objects that a bake was made from and that still exist; none if its description is damaged."""
    if is_linked(bake):
        # Its shapes are in another file, where they may have the names of objects of this one.
        return []
    try:
        return [obj for obj in stored_morph(bake).objects if obj is not None]
    except ConvwassError:
        # A damaged description is reported where it is used.
        return []


def _morph_of_frame(obj: bpy.types.Object) -> bpy.types.Collection | None:
    homes = obj.users_collection if WEIGHTS_KEY in obj else ()
    morphs = (home.get(FRAMES_KEY, home) for home in homes)
    return next((morph for morph in morphs if MORPH_KEY in morph), None)
