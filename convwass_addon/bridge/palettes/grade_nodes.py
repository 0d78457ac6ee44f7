# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A compositor node group that applies a lookup table.

Blender has no node for lookup tables, but *Map UV* can read any pixel of an image. The table is stored in an image as
one tile per blue value; the eight entries around a color are read and interpolated trilinearly.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, sqrt

import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.palettes.lookup_table import LookupTable
from ..color_spaces import SRGB, color_space
from ..files.data_images import data_image
from ..last_result import last_result
from ..nodes.node_math import feed, math_node, mixed, new_node
from ..unused_data import remove_if_unused

Socket = bpy.types.NodeSocket

_COLUMN = 180.0


RESULT_OF = "convwass_grade"
"""Custom property of a node group that applies a table: the name it was given."""

_SOURCE = "convwass_grade_source"
"""Custom property of such a group: the image that the table was made for."""


def grade_group(table: LookupTable, name: str, source: bpy.types.Image | None = None) -> bpy.types.NodeTree:
    """Create a compositor node group that applies a table to an image.

    An existing group of the same name and source is rebuilt, and stays in use.

    Colors inside the table's domain are interpolated; the excess of brighter colors over the domain is preserved.

    Parameters
    ----------
    table : LookupTable
        Table of sRGB encoded colors.
    name : str
        Name of the group and of the image with the table.
    source : bpy.types.Image, optional
        The image that the table was made for.
    """
    group = _emptied_group(name, source)
    tiles = _Tiles(len(table.colors))
    grade = _Grade(group, tiles, data_image(name, tiles.laid_out(table.colors)))
    came_in = group.nodes.new("NodeGroupInput").outputs["Image"]
    encoded, alpha = grade.encoded(came_in)
    lows, spans = table.lowest.tolist(), (table.highest - table.lowest).tolist()
    shares = [
        math_node(group, "DIVIDE", math_node(group, "SUBTRACT", channel, low), span)
        for channel, low, span in zip(encoded, lows, spans, strict=True)
    ]
    inside = [grade.limited(share, 0.0, 1.0) for share in shares]
    beyond = [
        math_node(group, "MULTIPLY", math_node(group, "SUBTRACT", share, own), span)
        for share, own, span in zip(shares, inside, spans, strict=True)
    ]
    found = grade.separated(grade.looked_up(inside))
    result = [math_node(group, "ADD", own, rest) for own, rest in zip(found, beyond, strict=True)]
    group.links.new(grade.decoded(result, alpha), group.nodes.new("NodeGroupOutput").inputs["Image"])
    _arrange(group)
    return group


def _emptied_group(name: str, source: bpy.types.Image | None) -> bpy.types.NodeTree:
    """Return the existing group without its nodes, or a new one."""
    known = (own for own in bpy.data.node_groups if _is_for(own, name, source) and _has_ends(own))
    group = last_result(known, name)
    if group is None:
        group = bpy.data.node_groups.new(name, "CompositorNodeTree")
        group.interface.new_socket("Image", in_out="INPUT", socket_type="NodeSocketColor")
        group.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    group[RESULT_OF] = name
    if source is not None:
        group[_SOURCE] = source
    tables = {node.image for node in group.nodes if node.type == "IMAGE" and node.image is not None}
    group.nodes.clear()
    remove_if_unused(tables)
    return group


def _is_for(group: bpy.types.NodeTree, name: str, source: bpy.types.Image | None) -> bool:
    """Return whether a group was made with a name for a table of an image."""
    # Earlier versions stored the name of the image, too.
    known, _, earlier = str(group.get(RESULT_OF, "")).partition("\n")
    return known == name and source == (bpy.data.images.get((earlier, None)) if earlier else group.get(_SOURCE))


def _has_ends(group: bpy.types.NodeTree) -> bool:
    """Return whether a group still has its input and its output."""
    sockets = {(item.name, item.in_out) for item in group.interface.items_tree if item.item_type == "SOCKET"}
    return {("Image", "INPUT"), ("Image", "OUTPUT")} <= sockets


@dataclass(frozen=True)
class _Tiles:
    """Layout of a table in an image: red to the right and green upwards, with one tile per blue value."""

    size: int

    @property
    def columns(self) -> int:
        """Number of tiles per row."""
        return ceil(sqrt(self.size))

    @property
    def rows(self) -> int:
        """Rows of tiles."""
        return ceil(self.size / self.columns)

    def laid_out(self, colors: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return the colors of the pixels of the image, (height, width, 3)."""
        size = self.size
        # Tiles that are left over are white.
        pixels = np.ones((self.rows * size, self.columns * size, 3), dtype=np.float32)
        for blue in range(size):
            row, column = divmod(blue, self.columns)
            tile = colors[:, :, blue].transpose(1, 0, 2)
            pixels[row * size : (row + 1) * size, column * size : (column + 1) * size] = tile
        return pixels


@dataclass(frozen=True)
class _Grade:
    """Builds the parts of the group."""

    group: bpy.types.NodeTree
    tiles: _Tiles
    image: bpy.types.Image

    def encoded(self, came_in: Socket) -> tuple[list[Socket], Socket]:
        """Return sRGB encoded red, green and blue with straight alpha, and alpha."""
        straight = self._alpha_node(came_in, to_straight=True)
        convert = new_node(
            self.group, "CompositorNodeConvertColorSpace", {0: straight}, to_color_space=color_space(SRGB)
        )
        *channels, alpha = new_node(self.group, "CompositorNodeSeparateColor", {0: convert.outputs[0]}).outputs
        return channels, alpha

    def decoded(self, channels: list[Socket], alpha: Socket) -> Socket:
        """Convert channels back to a scene linear color with premultiplied alpha."""
        join = new_node(self.group, "CompositorNodeCombineColor", dict(enumerate((*channels, alpha))))
        convert = self.group.nodes.new("CompositorNodeConvertColorSpace")
        # By default, a new node converts from the scene's color space.
        scene, convert.from_color_space = convert.from_color_space, color_space(SRGB)
        convert.to_color_space = scene
        self.group.links.new(join.outputs[0], convert.inputs[0])
        return self._alpha_node(convert.outputs[0], to_straight=False)

    def _alpha_node(self, color: Socket, *, to_straight: bool) -> Socket:
        node = self.group.nodes.new("CompositorNodePremulKey")
        if "Type" in node.inputs:
            node.inputs["Type"].default_value = "To Straight" if to_straight else "To Premultiplied"
        else:
            node.mapping = "PREMUL_TO_STRAIGHT" if to_straight else "STRAIGHT_TO_PREMUL"
        self.group.links.new(color, node.inputs["Image"])
        return node.outputs[0]

    def limited(self, value: Socket, least: float, most: float) -> Socket:
        """Return a value clamped to a range."""
        return math_node(self.group, "MINIMUM", math_node(self.group, "MAXIMUM", value, least), most)

    def separated(self, color: Socket) -> list[Socket]:
        """Return the red, green and blue channels."""
        return list(new_node(self.group, "CompositorNodeSeparateColor", {0: color}).outputs)[:3]

    def looked_up(self, shares: list[Socket]) -> Socket:
        """Return the interpolated table color at coordinates from 0 to 1."""
        last = self.tiles.size - 1
        scaled = [math_node(self.group, "MULTIPLY", share, float(last)) for share in shares]
        below = [self.limited(math_node(self.group, "FLOOR", own), 0.0, last - 1.0) for own in scaled]
        parts = [math_node(self.group, "SUBTRACT", own, low) for own, low in zip(scaled, below, strict=True)]
        slices = []
        for step in (0.0, 1.0):
            column, row = self._tile(math_node(self.group, "ADD", below[2], step))
            corners = [
                [self._read(column, row, below[0], below[1], right, up) for right in (0.0, 1.0)] for up in (0.0, 1.0)
            ]
            rows = [self._mixed(parts[0], *pair) for pair in corners]
            slices.append(self._mixed(parts[1], *rows))
        return self._mixed(parts[2], *slices)

    def _tile(self, blue: Socket) -> tuple[Socket, Socket]:
        """Return the column and the row of a tile."""
        # Adding half a step prevents rounding to the row before.
        middle = math_node(self.group, "ADD", blue, 0.5)
        row = math_node(self.group, "FLOOR", math_node(self.group, "DIVIDE", middle, float(self.tiles.columns)))
        column = math_node(self.group, "MULTIPLY_ADD", row, -float(self.tiles.columns), blue)
        return column, row

    def _read(self, column: Socket, row: Socket, red: Socket, green: Socket, right: float, up: float) -> Socket:
        """Read the pixel of a color."""
        size, place = float(self.tiles.size), self.group.nodes.new("ShaderNodeCombineXYZ")
        counts = (self.tiles.columns, self.tiles.rows)
        for tile, own, step, count, axis in zip((column, row), (red, green), (right, up), counts, "XY", strict=True):
            pixel = math_node(self.group, "ADD", math_node(self.group, "MULTIPLY_ADD", tile, size, own), step + 0.5)
            self.group.links.new(math_node(self.group, "DIVIDE", pixel, size * count), place.inputs[axis])
        # In Blender 4.5 this input is the opacity of the result.
        place.inputs["Z"].default_value = 1.0
        source = new_node(self.group, "CompositorNodeImage", image=self.image)
        reader = self.group.nodes.new("CompositorNodeMapUV")
        if "Interpolation" in reader.inputs:
            reader.inputs["Interpolation"].default_value = "Nearest"
        else:
            reader.filter_type = "NEAREST"
        feed(self.group, [reader.inputs["Image"], reader.inputs["UV"]], [source.outputs["Image"], place.outputs[0]])
        return reader.outputs[0]

    def _mixed(self, share: Socket, first: Socket, second: Socket) -> Socket:
        found = mixed(self.group, "Color", share, first, second)
        found.node.clamp_factor = False
        return found


def _arrange(group: bpy.types.NodeTree) -> None:
    """Place every node to the right of its inputs."""
    depths: dict[str, int] = {}
    # Most nodes were created after their inputs; links decide the rest.
    for _ in range(len(group.nodes)):
        before = dict(depths)
        for link in group.links:
            reached = max(depths.get(link.to_node.name, 0), depths.get(link.from_node.name, 0) + 1)
            depths[link.to_node.name] = reached
        if depths == before:
            break
    filled: dict[int, int] = {}
    for node in group.nodes:
        depth = depths.get(node.name, 0)
        filled[depth] = filled.get(depth, 0) + 1
        node.location = (_COLUMN * depth, -_COLUMN * filled[depth])
        node.hide = True
