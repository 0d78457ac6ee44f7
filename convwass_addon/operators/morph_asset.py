# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Mark a baked morph for the Asset Browser."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ..bridge.mouse_progress import progress_at_mouse
from .morph_manage import OnActiveMorph, active_morph
from .reporting import reporting_errors


class CONVWASS_OT_mark_morph_asset(OnActiveMorph, bpy.types.Operator):
    """Mark the active morph as an asset with a preview: its player, nodes and materials, or its collection"""

    bl_idname = "convwass.mark_morph_asset"
    bl_label = "Mark Morph as Asset"

    @reporting_errors
    def execute(self, context):
        from ..bridge.morphs.pictures.asset_marking import mark_as_assets

        with progress_at_mouse():
            marked = mark_as_assets(active_morph(context))
        self.report({"INFO"}, rpt_("Marked as assets: {:s}").format(", ".join(block.name for block in marked)))
        return {"FINISHED"}


classes = (CONVWASS_OT_mark_morph_asset,)
