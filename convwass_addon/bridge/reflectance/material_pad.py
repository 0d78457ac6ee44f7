# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A pad for materials: an Empty is dragged in a square or triangle, and drivers pass its position to materials.

Blender evaluates the arithmetic of the drivers without Python, so a file needs neither scripts nor the add-on, and keys
on the Empty animate the blend.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy

from ...applications.live.pad_places import pad_corners, pad_height, pad_points
from ..keyframes import drivers_of
from ..pad_handles import OUTLINES, drive_by_handle, pad_handle, pad_labels, pad_lines

PAD_OF = "convwass_material_pad"
"""Custom property of the Empty of a pad: the blend that it drives."""

SIDE = 2.0
"""Length of a side of the pad."""

# Height of the names at the corners, and size of the Empty.
_TEXT, _HANDLE = 0.2, 0.1
# The tip of the triangle is a line of length zero.
_TIP = 1e-4


@dataclass(frozen=True)
class MaterialPad:
    """A pad.

    Attributes
    ----------
    handle : bpy.types.Object
        The Empty to drag; its parent is the visible lattice.
    count : int
        Number of materials, 3 or 4.
    side : int
        Blends along each side.
    """

    handle: bpy.types.Object
    count: int
    side: int

    def drive(self, across: bpy.types.NodeSocket, up: bpy.types.NodeSocket) -> None:
        """Let the place of the empty drive two sockets, from 0 to 1; see :func:`.weight_sheets.pad_weights`."""
        height = SIDE * pad_height(self.count)
        rising = f"min(max(z/{height:.6f}+0.5,0),1)"
        along = f"x/{SIDE:.6f}"
        if self.count == 3:
            along = f"{along}/max(1-{rising},{_TIP})"
        for socket, expression in ((across, f"min(max({along}+0.5,0),1)"), (up, rising)):
            drive_by_handle(socket.driver_add("default_value").driver, self.handle, expression)

    def movable(self, materials: Sequence[bpy.types.Material]) -> list[bpy.types.Material]:
        """Return which materials this pad may move: its own, or else those that no other pad in a scene moves."""
        own = [material for material in materials if self.handle in _handles_of(material)]
        return own or [one for one in materials if not any(other.users_scene for other in _handles_of(one))]


def _handles_of(material: bpy.types.Material) -> list[bpy.types.Object]:
    """Return the Empties of the pads that move a material."""
    drivers = [curve.driver for curve in drivers_of(material.node_tree)]
    read = {target.id for driver in drivers for variable in driver.variables for target in variable.targets}
    return [block for block in read if block is not None and PAD_OF in block]


def material_pad(scene: bpy.types.Scene, name: str, materials: Sequence[str], side: int) -> MaterialPad:
    """Create a pad at the 3D cursor, upright, or return the pad that drives the last result of that name.

    Parameters
    ----------
    scene : bpy.types.Scene
        Scene of the pad.
    name : str
        Name of the result.
    materials : sequence of str
        Names of three (bottom left, bottom right, top) or four (top left, top right, bottom left, bottom right).
    side : int
        Blends along each side.
    """
    own = (obj for obj in scene.objects if obj.get(PAD_OF) == name and obj.library is None)
    found = next(own, None)
    if found is not None:
        return MaterialPad(found, len(materials), side)
    parts = bpy.data.collections.new(f"{name} Pad")
    scene.collection.children.link(parts)
    corners = SIDE * pad_points(len(materials), pad_corners(len(materials)))
    lattice = pad_lines("Material Pad", corners, OUTLINES[len(corners)])
    lattice.location = scene.cursor.location
    parts.objects.link(lattice)
    handle = pad_handle("Material Handle", _HANDLE, corners, lattice)
    handle.location = corners.mean(axis=0)
    handle[PAD_OF] = name
    parts.objects.link(handle)
    for label in pad_labels(materials, corners, _TEXT, lattice, (0.6, -1.4)):
        parts.objects.link(label)
    return MaterialPad(handle, len(materials), side)
