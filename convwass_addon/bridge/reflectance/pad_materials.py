# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Create materials driven by an Empty on a pad: values of all blends are stored in images that nodes sample."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ..files.data_images import data_image
from ..unused_data import remove_if_unused
from .lobe_materials import (
    RESULT_OF,
    PrincipledFit,
    is_own,
    lobe_node,
    principled_node,
    principled_values,
    result_material,
    result_node,
)
from .lobe_nodes import ACROSS, DIFFUSE, UP, lobe_pad_group
from .material_pad import MaterialPad
from .sun_drivers import follow

PLACE = "Place on the Pad"
"""Name of the node whose X and Y the pad drives, from 0 to 1."""


def pad_lobe_material(
    name: str,
    tables: Sequence[NDArray[np.float32]],
    diffuse: Sequence[tuple[float, float, float]],
    sun: bpy.types.Object | None,
    pad: MaterialPad,
) -> bpy.types.Material:
    """Create a material that shows tables on a pad, or update the last result of that name.

    Parameters
    ----------
    name : str
        Name of the material.
    tables : sequence of (64, 256, 3) float32
        Tables of all positions of the pad, row by row from the bottom.
    diffuse : sequence of (3,) float
        Diffuse colors of all positions.
    sun : bpy.types.Object or None
        A sun that lights the material.
    pad : MaterialPad
        Drives the material.
    """
    material, tree = result_material(name, "PAD LOBES", choose=pad.movable)
    is_empty = not len(tree.nodes)
    place = _driven_place(tree, pad)
    node, is_new = lobe_node(tree, name, tables, lambda image: lobe_pad_group(image, pad.side))
    for slider, part in zip((ACROSS, UP), place, strict=True):
        part.feed(node.inputs[slider], is_new)
    _read(tree, pad.side, f"{name} Matte", diffuse, place).feed(node.inputs[DIFFUSE], is_new)
    follow(node, sun)
    if is_empty:
        _lay_out(tree)
    return material


def pad_fitted_material(name: str, fits: Sequence[PrincipledFit], pad: MaterialPad) -> bpy.types.Material:
    """Create a material with a Principled BSDF whose values depend on the pad; see `pad_lobe_material`."""
    material, tree = result_material(name, "PAD FITTED", choose=pad.movable)
    is_empty = not len(tree.nodes)
    place = _driven_place(tree, pad)
    node, is_new = principled_node(tree)
    values = [principled_values(fit) for fit in fits]
    colors = [own["Base Color"][:3] for own in values]
    _read(tree, pad.side, f"{name} Color", colors, place).feed(node.inputs["Base Color"], is_new)
    names = ("Roughness", "Anisotropic", "Metallic")
    numbers = [tuple(own[name] for name in names) for own in values]
    parts, are_new = result_node(tree, f"{name} Parts", "ShaderNodeSeparateXYZ")
    _read(tree, pad.side, f"{name} Values", numbers, place).feed(parts.inputs[0], are_new)
    for name_of, socket in zip(names, parts.outputs, strict=True):
        _Fed(socket, are_new).feed(node.inputs[name_of], is_new)
    turns, grain = [own["Anisotropic Rotation"] for own in values], f"{name} Grain"
    if any(turns) or any(own.get(RESULT_OF) == grain for own in tree.nodes):
        # Interpolation would rotate the anisotropy through oblique angles.
        turned = _read(tree, pad.side, grain, [(turn, turn, turn) for turn in turns], place, "Closest")
        turned.feed(node.inputs["Anisotropic Rotation"], is_new)
    if is_empty:
        _lay_out(tree)
    return material


@dataclass(frozen=True)
class _Fed:
    """An output of a node, and whether the node is new: links of earlier nodes are kept as the user has left them."""

    socket: bpy.types.NodeSocket
    is_new: bool

    def feed(self, target: bpy.types.NodeSocket, is_new: bool) -> None:
        """Link it to an input if one of the two nodes is new."""
        if self.is_new or is_new:
            target.id_data.links.new(self.socket, target)


def _driven_place(tree: bpy.types.NodeTree, pad: MaterialPad) -> tuple[_Fed, _Fed]:
    """Return the coordinates across and up of a node that the Empty drives."""
    node, is_new = result_node(tree, PLACE, "ShaderNodeCombineXYZ")
    node.label = PLACE
    for name in "XY":
        node.inputs[name].driver_remove("default_value")
    pad.drive(node.inputs["X"], node.inputs["Y"])
    parts, are_new = result_node(tree, f"{PLACE} Parts", "ShaderNodeSeparateXYZ")
    _Fed(node.outputs["Vector"], is_new).feed(parts.inputs["Vector"], are_new)
    return _Fed(parts.outputs["X"], are_new), _Fed(parts.outputs["Y"], are_new)


def _read(
    tree: bpy.types.NodeTree,
    side: int,
    name: str,
    values: Sequence[Sequence[float]],
    place: tuple[_Fed, _Fed],
    interpolation: str = "Linear",
) -> _Fed:
    """Write the values of all positions to an image, and sample it at one; positions are pixel centers."""
    texture, is_new = result_node(tree, name, "ShaderNodeTexImage")
    at, is_placed = result_node(tree, f"{name} Place", "ShaderNodeCombineXYZ")
    for part, axis in zip(place, "XY", strict=True):
        scaled, is_scaled = result_node(tree, f"{name} {axis}", "ShaderNodeMath")
        scaled.operation = "MULTIPLY_ADD"
        scaled.inputs[1].default_value, scaled.inputs[2].default_value = (side - 1) / side, 0.5 / side
        part.feed(scaled.inputs[0], is_scaled)
        _Fed(scaled.outputs[0], is_scaled).feed(at.inputs[axis], is_placed)
    _Fed(at.outputs["Vector"], is_placed).feed(texture.inputs["Vector"], is_new)
    before, texture.image = texture.image, None
    if is_own(before):
        remove_if_unused([before])
    image = data_image(name, np.asarray(values, dtype=np.float32).reshape(side, side, 3))
    image[RESULT_OF] = True
    texture.image = image
    if is_new:
        texture.interpolation, texture.extension = interpolation, "EXTEND"
    return _Fed(texture.outputs["Color"], is_new)


def _lay_out(tree: bpy.types.NodeTree) -> None:
    """Arrange the nodes from left to right in the order of evaluation."""
    for number, node in enumerate(tree.nodes):
        node.location = (220.0 * (number // 3 - len(tree.nodes) // 3), -260.0 * (number % 3))
