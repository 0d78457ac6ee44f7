# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Mark a baked morph for the Asset Browser."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ..bridge.mouse_progress import progress_at_mouse
from ..errors import ConvwassError
from .morph_manage import OnActiveMorph, active_morph
from .reporting import refuse_if_known


class CONVWASS_OT_mark_morph_asset(OnActiveMorph, bpy.types.Operator):
    """Mark the active morph as an asset with a preview: its player, nodes and materials, or its collection"""

    bl_idname = "convwass.mark_morph_asset"
    bl_label = "Mark Morph as Asset"

    def execute(self, context):
        from ..bridge.morphs.asset_marking import mark_as_assets

        try:
            with progress_at_mouse():
                marked = mark_as_assets(active_morph(context))
        except (ConvwassError, MemoryError) as error:
            return refuse_if_known(self, error)
        self.report({"INFO"}, rpt_("Marked as assets: {:s}").format(", ".join(block.name for block in marked)))
        return {"FINISHED"}


classes = (CONVWASS_OT_mark_morph_asset,)
