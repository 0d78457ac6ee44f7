# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Register groups of properties and the places where they are found."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import bpy
from bpy.props import PointerProperty

if TYPE_CHECKING:
    from ..bridge.soft_maps.pair_labels import PairLabels


def registration(
    classes: Sequence[type], places: Sequence[tuple[type, str, type]], labels: Sequence[PairLabels] = ()
) -> tuple[Callable[[], None], Callable[[], None]]:
    """Return the functions that register groups of properties, and that remove them.

    Parameters
    ----------
    classes : sequence of type
        The groups, each after those that it contains.
    places : sequence of (type, str, type)
        The type in Blender that has a group, such as Scene, the name of the group there, and its class.
    labels : sequence of PairLabels
        What to draw in viewports.
    """
    register_classes, unregister_classes = bpy.utils.register_classes_factory(classes)

    def register() -> None:
        register_classes()
        for owner, name, kind in places:
            setattr(owner, name, PointerProperty(type=kind))
        for own in labels:
            own.register()

    def unregister() -> None:
        for own in reversed(labels):
            own.unregister()
        for owner, name, _ in reversed(places):
            delattr(owner, name)
        unregister_classes()

    return register, unregister
