# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which object stores how the shape keys of an object were made."""

from __future__ import annotations

import bpy

from ..morphs.stored import MORPH_KEY

SWAP_KEY = "convwass_swap"
"""Custom property of both objects: the first one (`object`), the name of its slider, and its value `at` the swap."""


def shared_slider(obj: bpy.types.Object) -> tuple[bpy.types.Object, str] | None:
    """Return the object with the slider that moves a pair of objects, and the slider's name; None for other objects."""
    swap = obj.get(SWAP_KEY)
    if swap is None or swap.get("object") is None or swap["slider"] not in swap["object"]:
        return None
    return swap["object"], swap["slider"]


def baked_keys(obj: bpy.types.Object | None) -> bpy.types.Object | None:
    """Return the object that stores how the keys of an object were made: itself, or the first one of two; or None."""
    if obj is None:
        return None
    shared = shared_slider(obj)
    own = obj if shared is None else shared[0]
    return own if MORPH_KEY in own else None
