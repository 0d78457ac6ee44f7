# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Panel rows generated from the settings of the applications."""

from __future__ import annotations

import bpy

from ..schema import Setting, Settings, setting_of, settings_of


def draw_settings(layout: bpy.types.UILayout, own: bpy.types.PropertyGroup, kind: type[Settings], panel: str) -> None:
    """Draw the settings that belong to a panel, in their order.

    Parameters
    ----------
    layout : bpy.types.UILayout
        Where to draw.
    own : bpy.types.PropertyGroup
        Holds the properties of the settings.
    kind : type
        The settings class.
    panel : str
        Draw the settings that name this panel.
    """
    for one in settings_of(kind):
        if one.panel == panel and one.prop is not None:
            _draw(layout, own, one, _applies(own, kind, one))


def _applies(own: bpy.types.PropertyGroup, kind: type[Settings], one: Setting) -> bool:
    """Return whether a setting has an effect, given the others."""
    if not one.applies_when:
        return True
    other, value = one.applies_when
    wanted = setting_of(kind, other)
    return getattr(own, wanted.prop) == wanted.choice(value).identifier


def _draw(layout: bpy.types.UILayout, own: bpy.types.PropertyGroup, one: Setting, applies: bool) -> None:
    if one.switch is not None:
        row = layout.row(align=True, heading=own.bl_rna.properties[one.prop].name)
        row.prop(own, one.switch.name, text="")
        number = row.row(align=True)
        number.active = getattr(own, one.switch.name)
        number.prop(own, one.prop, text="")
        return
    if not applies:
        layout = layout.column()
        layout.active = False
    layout.prop(own, one.prop)
    if one.number is not None and getattr(own, one.prop) == "NUMBER":
        layout.prop(own, one.number.name)
