# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Inputs of the modifier that shows the blend of a pad.

Blender gives objects that are duplicated together inputs that refer to each other: a duplicated pad has its own handle.
"""

from __future__ import annotations

import bpy

from ....errors import InputError
from ...nodes.node_inputs import NodeInput, node_input
from ..stand_ins import frames_modifier, stand_ins

PAD, HANDLE = "Pad", "Handle"
"""Inputs of the modifier: the lattice, and the Empty whose place on it selects the blend."""

HANDLE_VELOCITY = "Handle Velocity"
"""Input of the modifier: velocity of the handle in local space of the pad, per second."""


def pad_input(modifier: bpy.types.NodesModifier | None, name: str) -> NodeInput | None:
    """Return an input of a modifier; None without one, such as of other objects and of pads of earlier versions."""
    try:
        return None if modifier is None else node_input(modifier, name)
    except InputError:
        return None


def pad_part(modifier: bpy.types.NodesModifier, name: str) -> bpy.types.Object | None:
    """Return the lattice or the handle, by the name of the input, if it still exists."""
    found = pad_input(modifier, name)
    return None if found is None else found.get()


def handle_velocities(collection: bpy.types.Collection) -> list[NodeInput]:
    """Return the velocities of the handles of a morph's pads that interpolate: of its pad, and of duplicates of it."""
    found = (pad_input(frames_modifier(obj), HANDLE_VELOCITY) for obj in stand_ins(collection))
    return [velocity for velocity in found if velocity is not None]


def handle_velocity(collection: bpy.types.Collection, part: bpy.types.Object | None) -> NodeInput | None:
    """Return the velocity of the handle of the pad with some part, or else of the first pad; None without a pad."""
    found = handle_velocities(collection)
    return next((own for own in found if part in _parts(own.modifier)), next(iter(found), None))


def _parts(modifier: bpy.types.NodesModifier) -> tuple[bpy.types.Object | None, ...]:
    return modifier.id_data, pad_part(modifier, PAD), pad_part(modifier, HANDLE)
