# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Two objects, one of which replaces the other while a slider moves."""

from __future__ import annotations

import bpy

from .baked_keys import SWAP_KEY
from .shape_keys import add_slider, drive, free_slider, slider_path


def with_swap(
    first: bpy.types.Object, second: bpy.types.Object, sliders: tuple[str | None, str | None], name: str, time: float
) -> str:
    """Let a slider of the first object move both objects and show one of them; return its name.

    All drivers are simple expressions, which Blender evaluates without running scripts.

    Parameters
    ----------
    first, second : bpy.types.Object
        The objects.
    sliders : (str or None, str or None)
        The slider of each object that leads towards the other one; None for an object that keeps its form. That of the
        second object is driven backward.
    name : str
        Name of the second shape, after which the slider of a first object that keeps its form is named.
    time : float
        Value of the slider at which the second object replaces the first one: if it is 0, the first one is shown at 0
        only.
    """
    own, other = sliders
    if own is None:
        own = free_slider(first, name)
        add_slider(first, own)
    if other is not None:
        drive(second.driver_add(slider_path(other)), first, own, "1 - v")
    over, under = (f"v >= {time:.6g}", f"v < {time:.6g}") if time > 0.0 else ("v > 0", "v <= 0")
    for obj, hidden in ((first, over), (second, under)):
        for place in ("hide_viewport", "hide_render"):
            drive(obj.driver_add(place), first, own, hidden)
    for obj in (first, second):
        obj[SWAP_KEY] = {"object": first, "slider": own, "at": time}
    if not (first.parent or second.parent or first.modifiers or second.modifiers):
        second.parent = first
    return own
