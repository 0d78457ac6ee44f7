# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Inputs of Geometry Nodes modifiers, which Blender 5.2 keeps in another place than its predecessors."""

from __future__ import annotations

from dataclasses import dataclass

import bpy

from ..errors import InputError


@dataclass(frozen=True)
class NodeInput:
    """One input of a Geometry Nodes modifier, as ``owner.keyframe_insert(path)`` and ``layout.prop(owner, path)`` want.

    Attributes
    ----------
    modifier : bpy.types.NodesModifier
        Whose input it is.
    owner : bpy.types.bpy_struct
        What holds the value.
    path : str
        Where in `owner`.
    data_path : str
        Where in the object, as F-curves and drivers name it.
    """

    modifier: bpy.types.NodesModifier
    owner: bpy.types.bpy_struct
    path: str
    data_path: str

    def get(self) -> object:
        """Return the value; of a menu its text from Blender 5.2 on, and its number before."""
        return self.owner.path_resolve(self.path)

    def set(self, value: object) -> None:
        """Set the value; of a menu in the same way."""
        if self.path.startswith("["):
            self.owner[self.path[2:-2]] = value
        else:
            setattr(self.owner, self.path, value)
        # Blender 4.5 does not notice otherwise.
        self.modifier.id_data.update_tag()

    def set_item(self, items: tuple[str, ...], item: str) -> None:
        """Choose one of the items of a menu, numbered from 0 in the order of `items`."""
        self.set(items.index(item) if self.path.startswith("[") else item)


def node_input(modifier: bpy.types.NodesModifier, name: str) -> NodeInput:
    """Find an input of a modifier by the name that the user sees.

    Parameters
    ----------
    modifier : bpy.types.NodesModifier
        With a node group.
    name : str
        Such as "Material".

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
            "The modifier {modifier} of {object} has no input {name}; make it anew.",
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
