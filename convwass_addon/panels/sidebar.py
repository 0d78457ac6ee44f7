# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Base classes and helpers for panels in the sidebar."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Mapping
from inspect import get_annotations

import bpy

# Average width of a letter, and the width of icon and margins, in pixels at UI scale 1.
_LETTER, _MARGINS = 6.2, 60.0
_FEWEST_LETTERS = 16


class Sidebar:
    """A panel on the add-on's tab in the 3D viewport."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Convwass"


class ImageSidebar:
    """A panel on the add-on's tab in the Image Editor."""

    bl_space_type = "IMAGE_EDITOR"
    bl_region_type = "UI"
    bl_category = "Convwass"


def draw_switch(row: bpy.types.UILayout, item: bpy.types.PropertyGroup) -> bpy.types.UILayout:
    """Draw the switch of a list item; return the layout for the rest, gray if disabled."""
    row.use_property_split = False
    row.prop(item, "enabled", text="")
    shown = row.row(align=True)
    shown.active = item.enabled
    return shown


def draw_numbered(row: bpy.types.UILayout, item: bpy.types.PropertyGroup, index: int) -> bpy.types.UILayout:
    """Draw switch, number and name of a list item; return the layout for the rest, gray if disabled."""
    shown = draw_switch(row, item)
    number = shown.row(align=True)
    number.ui_units_x = 1.1
    number.label(text=str(index + 1), translate=False)
    shown.prop(item, "label", text="")
    return shown


def draw_wrapped(layout: bpy.types.UILayout, context: bpy.types.Context, text: str, icon: str) -> None:
    """Draw a text wrapped to the width of the region, with an icon on the first line."""
    # In background mode there is no window and the scale is 0.
    scale = context.preferences.system.ui_scale
    width = context.region.width / scale if context.region and scale > 0 else 0.0
    column = layout.column(align=True)
    column.scale_y = 0.8
    for line in textwrap.wrap(text, max(int((width - _MARGINS) / _LETTER), _FEWEST_LETTERS)):
        column.label(text=line, icon=icon, translate=False)
        icon = "BLANK1"


def with_labels_beside(layout: bpy.types.UILayout) -> bpy.types.UILayout:
    """Let a layout draw labels to the left of their properties, without dots for keyframes; return it."""
    layout.use_property_split = True
    layout.use_property_decorate = False
    return layout


def slots(own: bpy.types.PropertyGroup, names: Iterable[str], least: int = 1) -> list[str]:
    """Return the slots to draw: the filled ones and the first empty one, at least `least` in total."""
    filled = [name for name in names if getattr(own, name) is not None]
    spare = [name for name in names if name not in filled]
    shown = {*filled, *spare[: max(1, least - len(filled))]}
    return [name for name in names if name in shown]


def draw_slots(
    layout: bpy.types.UILayout, own: bpy.types.PropertyGroup, weights: Mapping[str, str], has_weights: bool
) -> None:
    """Draw the filled slots and an empty one, the filled ones with their weights, `weights`, if these are used."""
    for name in slots(own, weights):
        row = layout.row(align=True)
        row.prop(own, name, text="")
        if has_weights and getattr(own, name) is not None:
            weight = row.row(align=True)
            weight.ui_units_x = 3.5
            weight.prop(own, weights[name], text="")


def large_button(
    layout: bpy.types.UILayout,
    operator: type[bpy.types.Operator],
    icon: str,
    own: bpy.types.PropertyGroup,
    kind: type,
    enabled: bool = True,
) -> bpy.types.OperatorProperties:
    """Draw the main button of a panel; the operator takes the annotated properties of a class from a property group."""
    row = layout.row()
    row.scale_y, row.enabled = 1.6, enabled
    button = row.operator(operator.bl_idname, icon=icon)
    fill_operator(button, own, kind)
    return button


def fill_operator(operator: bpy.types.OperatorProperties, own: bpy.types.PropertyGroup, kind: type) -> None:
    """Copy the annotated properties of a class from a property group to an operator."""
    names = [name for base in kind.__mro__ for name in get_annotations(base)]
    for name in names:
        setattr(operator, name, getattr(own, name))
