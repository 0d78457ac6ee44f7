# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Inputs of Geometry Nodes modifiers, which are stored differently from Blender 5.2 on."""

from __future__ import annotations

from dataclasses import dataclass

import bpy

from ...errors import InputError
from ..keyframes import curves_of


@dataclass(frozen=True)
class NodeInput:
    """An input of a Geometry Nodes modifier, for ``owner.keyframe_insert(path)`` and ``layout.prop(owner, path)``.

    Attributes
    ----------
    modifier : bpy.types.NodesModifier
        The modifier with the input.
    owner : bpy.types.bpy_struct
        Holds the value.
    path : str
        Path of the value within `owner`.
    data_path : str
        Path within the object, for F-curves and drivers.
    """

    modifier: bpy.types.NodesModifier
    owner: bpy.types.bpy_struct
    path: str
    data_path: str

    def get(self) -> object:
        """Return the value; for a menu, its text from Blender 5.2 on, and its index before."""
        return self.owner.path_resolve(self.path)

    def set(self, value: object) -> None:
        """Set the value, in the form that `get` returns."""
        if self.path.startswith("["):
            self.owner[self.path[2:-2]] = value
        else:
            setattr(self.owner, self.path, value)
        # Blender 4.5 does not update otherwise.
        self.modifier.id_data.update_tag()

    def set_item(self, items: tuple[str, ...], item: str) -> None:
        """Select an item of a menu, given all `items` in order."""
        self.set(items.index(item) if self.path.startswith("[") else item)

    def curves(self) -> list[bpy.types.FCurve]:
        """Return the F-curves of the value, one for each of its numbers that has keys."""
        return curves_of(self.modifier.id_data, self.data_path)

    def curve(self) -> bpy.types.FCurve | None:
        """Return the F-curve of a value that is one number, or None."""
        return next(iter(self.curves()), None)


def node_input(modifier: bpy.types.NodesModifier, name: str) -> NodeInput:
    """Find an input of a modifier by its displayed name.

    Parameters
    ----------
    modifier : bpy.types.NodesModifier
        A modifier with a node group.
    name : str
        Name of the input, such as "Material".

    Raises
    ------
    InputError
        The node group has no such input.
    """
    sockets = modifier.node_group.interface.items_tree if modifier.node_group else ()
    found = (item for item in sockets if item.item_type == "SOCKET" and item.in_out == "INPUT" and item.name == name)
    socket = next(found, None)
    if socket is None:
        raise InputError(
            "The modifier {modifier} of {object} has no input {name}; create it again.",
            modifier=modifier.name,
            object=modifier.id_data.name,
            name=name,
        )
    where = f'modifiers["{bpy.utils.escape_identifier(modifier.name)}"]'
    if bpy.app.version >= (5, 2):
        owner = getattr(modifier.properties.inputs, socket.identifier)
        return NodeInput(modifier, owner, "value", f"{where}.properties.inputs.{socket.identifier}.value")
    path = f'["{socket.identifier}"]'
    return NodeInput(modifier, modifier, path, where + path)
