# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pick pairs of vertices with alternating clicks on the two objects."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ..errors import InputError
from ..properties.soft_maps import CONVWASS_PG_map_pair, CONVWASS_PG_soft_map
from ..translations import translated
from .picking import PicksPoints, nearest_hit, redraw_views
from .windows import write_status


class PicksPair(PicksPoints):
    """Base of operators that add pairs by clicks, if there is a window and no vertices are given or selected.

    Each pair has its own undo step. Must precede the other base classes.
    """

    def invoke(self, context, event):
        own = context.scene.convwass_soft_map
        is_given = self.source_vertex >= 0 or self.target_vertex >= 0
        if is_given or bpy.app.background or context.mode == "EDIT_MESH":
            return self.execute(context)
        self._say(context, own)
        return self._wait(context)

    def cancel(self, context):
        own = context.scene.convwass_soft_map
        if _half_pair(own) is not None:
            own.pairs.remove(len(own.pairs) - 1)
            own.active_pair = max(len(own.pairs) - 1, 0)
        PicksPoints.cancel(self, context)
        redraw_views(context)

    def _is_over(self, context):
        own = context.scene.convwass_soft_map
        return own.source is None or own.target is None

    def _take(self, context, region, place):
        own = context.scene.convwass_soft_map
        # Source and target may be the same object.
        shown = dict.fromkeys((own.source, own.target))
        hit = nearest_hit(shown, context.evaluated_depsgraph_get(), region, place)
        if hit is None:
            self.report({"INFO"}, rpt_("This is not on the source or the target; click on their surfaces"))
        else:
            self._add_vertex(own, *hit)
        self._say(context, own)
        redraw_views(context)
        return {"RUNNING_MODAL"}

    def _add_vertex(self, own: CONVWASS_PG_soft_map, obj: bpy.types.Object, vertex: int) -> None:
        """Add a clicked vertex to the incomplete pair; another click on the same object replaces it."""
        pair = _half_pair(own)
        # If source and target are the same object, the second click is the target vertex.
        is_source = obj == own.source and (own.source != own.target or pair is None)
        try:
            require_free(own, vertex, is_source)
        except InputError as error:
            self.report({"WARNING"}, translated(error.sentence))
            return
        if pair is None:
            pair = own.pairs.add()
            own.active_pair = len(own.pairs) - 1
        if is_source:
            pair.source_vertex = vertex
        else:
            pair.target_vertex = vertex
        if pair.is_complete:
            bpy.ops.ed.undo_push(message=rpt_("Add Pair"))

    def _say(self, context: bpy.types.Context, own: CONVWASS_PG_soft_map) -> None:
        """Show in the status bar what to click next."""
        pair = _half_pair(own)
        number = len(own.pairs) + (pair is None)
        if pair is None:
            text = rpt_("Pair {:d}: click on {:s} or {:s}    Esc: done").format(
                number, own.source.name, own.target.name
            )
        else:
            other = own.target if pair.target_vertex < 0 else own.source
            text = rpt_("Pair {:d}: now click on {:s}    Esc: done").format(number, other.name)
        write_status(context, text)


def require_free(own: CONVWASS_PG_soft_map, vertex: int, is_source: bool) -> None:
    """Raise InputError if a vertex of the source or target is already in a pair."""
    for number, pair in enumerate(own.pairs, start=1):
        if pair.enabled and pair.is_complete and vertex == own.vertices_now(pair)[0 if is_source else 1]:
            raise InputError(
                "Vertex {vertex} of {object} is already in pair {number}; remove that pair first.",
                vertex=vertex,
                object=(own.source if is_source else own.target).name,
                number=number,
            )


def _half_pair(own: CONVWASS_PG_soft_map) -> CONVWASS_PG_map_pair | None:
    """Return the incomplete pair, which can only be the last one."""
    return own.pairs[-1] if own.pairs and not own.pairs[-1].is_complete else None
