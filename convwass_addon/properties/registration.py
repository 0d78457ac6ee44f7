# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Register groups of properties and the places where they are found."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import bpy
from bpy.props import PointerProperty

if TYPE_CHECKING:
    from ..bridge.viewport_overlay import ViewportOverlay


def registration(
    classes: Sequence[type], places: Sequence[tuple[type, str, type]], overlays: Sequence[ViewportOverlay] = ()
) -> tuple[Callable[[], None], Callable[[], None]]:
    """Return the functions that register groups of properties, and that remove them.

    Parameters
    ----------
    classes : sequence of type
        The groups, each after those that it contains.
    places : sequence of (type, str, type)
        The type in Blender that has a group, such as Scene, the name of the group there, and its class.
    overlays : sequence of ViewportOverlay
        What to draw in viewports.
    """
    register_classes, unregister_classes = bpy.utils.register_classes_factory(classes)

    def register() -> None:
        register_classes()
        for owner, name, kind in places:
            setattr(owner, name, PointerProperty(type=kind))
        for own in overlays:
            own.register()

    def unregister() -> None:
        for own in reversed(overlays):
            own.unregister()
        for owner, name, _ in reversed(places):
            delattr(owner, name)
        unregister_classes()

    return register, unregister
