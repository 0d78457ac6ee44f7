# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The panels of a baked morph."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
from bpy.app.translations import pgettext_iface as iface_

from ..bridge.morphs.changes import changed_inputs
from ..bridge.morphs.players.pad_inputs import handle_velocities
from ..bridge.morphs.players.player_inputs import detail, interpolation, is_player, morph_value, playback
from ..bridge.morphs.stand_ins import shows_frames
from ..bridge.morphs.stored import ALONE_KEY, frame_objects, stored_diagnostics
from ..operators.morph_manage import active_morph
from ..translations import translated
from .sidebar import Sidebar, draw_wrapped

_ICONS = {"INFO": "INFO", "WARNING": "ERROR", "ERROR": "CANCEL"}

_WRITING = (
    ("convwass.make_volume", "OUTLINER_OB_VOLUME"),
    ("convwass.make_cache", "FILE_CACHE"),
    ("convwass.export_morph", "EXPORT"),
)
_MANAGING = (
    ("convwass.select_morph_inputs", "RESTRICT_SELECT_OFF"),
    ("convwass.mark_morph_asset", "ASSET_MANAGER"),
    ("convwass.delete_morph", "TRASH"),
)


def draw_changes(
    layout: bpy.types.UILayout, context: bpy.types.Context, bake: bpy.types.Collection | bpy.types.Object
) -> None:
    """Draw which inputs of a bake have changed since, if any."""
    changed = changed_inputs(bake)
    if changed:
        text = iface_("Changed since it was baked: {:s}").format(", ".join(changed))
        draw_wrapped(layout, context, text, "ERROR")


class CONVWASS_PT_baked_morph(Sidebar, bpy.types.Panel):
    """The morph that the active object belongs to"""

    bl_label = "Baked Morph"
    bl_idname = "CONVWASS_PT_baked_morph"

    @classmethod
    def poll(cls, context):
        return active_morph(context) is not None

    def draw(self, context):
        layout = self.layout
        morph = active_morph(context)
        layout.label(text=morph.name, icon="OUTLINER_COLLECTION", translate=False)
        draw_changes(layout, context, morph)
        if is_player(context.object):
            column = layout.column(align=True)
            for value, name in ((morph_value(context.object), "Morph"), (playback(context.object), "Playback")):
                column.prop(value.owner, value.path, text=iface_(name))
            switch = interpolation(context.object)
            if switch is not None:
                column.prop(switch.owner, switch.path, text=iface_("Interpolate"))
                own = detail(context.object)
                column.prop(own.owner, own.path, text=iface_("Detail"))
            row = layout.row(align=True)
            row.operator_menu_enum("convwass.retime_player", "style", icon="TIME")
            if switch is not None:
                row.operator("convwass.update_player_speed", text="", icon="MOD_TIME")
            layout.operator("convwass.bake_player", icon="RENDER_ANIMATION")
        if handle_velocities(morph):
            layout.operator("convwass.update_pad_velocity", icon="MOD_TIME")
        frames = frame_objects(morph)
        # A volume or cache has replaced the frames, or one object shows all of them: no other output can be made.
        if frames and not any(ALONE_KEY in obj for obj in frames):
            _draw_outputs(layout, morph, frames)
        column = layout.column(align=True)
        row = column.row(align=True)
        row.operator("convwass.rebake_morph", icon="FILE_REFRESH")
        row.operator_menu_enum("convwass.rebake_morph", "which", text="", icon="DOWNARROW_HLT")
        for name, icon in _MANAGING:
            column.operator(name, icon=icon)


class CONVWASS_PT_morph_diagnostics(Sidebar, bpy.types.Panel):
    """Quality of the meshes, and how to improve it"""

    bl_label = "Diagnostics"
    bl_idname = "CONVWASS_PT_morph_diagnostics"
    bl_parent_id = "CONVWASS_PT_baked_morph"

    def draw(self, context):
        notes = stored_diagnostics(active_morph(context))
        if not notes:
            self.layout.label(text="No diagnostics available", icon="QUESTION")
        for note in notes:
            icon = "CHECKMARK" if note.kind == "GOOD" else _ICONS[note.severity]
            draw_wrapped(self.layout, context, translated(note.sentence), icon)


def _draw_outputs(layout: bpy.types.UILayout, morph: bpy.types.Collection, frames: Sequence[bpy.types.Object]) -> None:
    """Draw the buttons that make other outputs of a morph."""
    column = layout.column(align=True)
    # The baked objects are hidden while a player or pad shows the morph.
    if not shows_frames(morph):
        column.operator("convwass.remove_player", icon="LOOP_BACK")
    elif len(frames) > 1:
        name, icon = ("player", "PLAY") if frames[0].animation_data is not None else ("blend_pad", "EMPTY_AXIS")
        column.operator(f"convwass.make_{name}", icon=icon)
    column = layout.column(align=True)
    for name, icon in _WRITING:
        column.operator(name, icon=icon)


classes = (CONVWASS_PT_baked_morph, CONVWASS_PT_morph_diagnostics)
