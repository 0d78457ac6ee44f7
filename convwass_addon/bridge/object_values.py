# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Read what materials read of an object: its color, its index, its place, its random number and its properties."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import bpy

from .nodes.shown_nodes import nodes_of

Color = tuple[float, float, float, float]

# What Attribute nodes show of a property that is not found, or has more components.
_NOTHING = (0.0, 0.0, 0.0, 0.0)
# Blender's limit for names of custom properties.
_LONGEST = 63
_BITS = 0xFFFFFFFF


@dataclass(frozen=True)
class ObjectValues:
    """What materials read of an object.

    Attributes
    ----------
    color : (r, g, b, a)
        Color of the object, scene linear.
    index : int
        Its pass index.
    location : (x, y, z)
        Its place in world space.
    random : float
        The number between 0 and 1 that *Object Info* shows.
    properties : dict of str to (r, g, b, a)
        Its properties that Attribute nodes read, as these show them.
    """

    color: Color = (1.0, 1.0, 1.0, 1.0)
    index: int = 0
    location: tuple[float, float, float] = (0.0, 0.0, 0.0)
    random: float = 0.0
    properties: Mapping[str, Color] = field(default_factory=dict)

    @classmethod
    def of(cls, obj: bpy.types.Object, materials: Sequence[bpy.types.Material | None]) -> ObjectValues:
        """Read what some materials can read of an object."""
        names = {node.attribute_name for node in nodes_of(materials) if reads_property(node)}
        return cls(
            tuple(obj.color),
            obj.pass_index,
            tuple(obj.matrix_world.translation),
            _random_number(obj.name),
            {name: shown_property((obj, obj.data), name) for name in sorted(names)},
        )

    def write_to(self, obj: bpy.types.Object) -> None:
        """Let materials read the same color, index and properties of another object."""
        obj.color, obj.pass_index = self.color, self.index
        write_properties(obj, self.properties)


def reads_property(node: bpy.types.Node) -> bool:
    """Return whether a node reads a property of the object; that of an instancer is the object's if there is none."""
    return node.type == "ATTRIBUTE" and node.attribute_type in ("OBJECT", "INSTANCER") and bool(node.attribute_name)


def shown_property(blocks: Sequence[bpy.types.bpy_struct | None], name: str) -> Color:
    """Return a property as Attribute nodes show it.

    Parameters
    ----------
    blocks : sequence of bpy.types.bpy_struct or None
        Where Blender looks for it, in this order; in each, custom properties come first.
    name : str
        Its name, or the path of one that is no custom property.
    """
    for block in blocks:
        value = None if block is None else block.get(name)
        if value is None and block is not None:
            try:
                value = block.path_resolve(name)
            except (ValueError, IndexError):  # no such property
                continue
        color = _color(value)
        if color is not None:
            return color
    return _NOTHING


def write_properties(block: bpy.types.bpy_struct, properties: Mapping[str, Color]) -> None:
    """Store values as custom properties; longer names than these can have are left out."""
    for name, value in properties.items():
        if len(name.encode()) <= _LONGEST:
            block[name] = value


def _random_number(name: str) -> float:
    """Return the random number of an object that is no instance, which Blender makes of its name.

    The bytes of the name are the digits of a number, which is hashed as by Jenkins' lookup3 (`BLI_hash_int_2d`).
    """
    number = 0
    for byte in name.encode():
        number = (37 * number + byte) & _BITS
    last = changed = (0xDEADBEEF + (2 << 2) + 13) & _BITS
    other = (last + number) & _BITS
    for turn in (14, 11, 25, 16, 4, 14, 24):
        turned = (last << turn | last >> (32 - turn)) & _BITS
        last, changed, other = ((changed ^ last) - turned) & _BITS, other, last
    return last / _BITS


def _color(value: object) -> Color | None:
    """Return a number as gray, and up to four as a color; None if it is anything else."""
    if isinstance(value, (bool, int, float)):
        return (float(value),) * 3 + (1.0,)
    parts = list(value) if hasattr(value, "__len__") and not isinstance(value, str) else []
    if not 1 <= len(parts) <= 4 or any(isinstance(one, bool) or not isinstance(one, (int, float)) for one in parts):
        return None
    return (*map(float, parts), *(0.0, 0.0, 0.0, 1.0)[len(parts) :])
