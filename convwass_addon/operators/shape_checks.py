# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Check shapes on the list of inputs in the background."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ..bridge.flat.flat_kinds import looks_flat
from ..sentence import Sentence
from ..translations import translated
from .background import BackgroundOperator

if TYPE_CHECKING:
    from ..applications.morphs.shape_check import ShapeFindings
    from ..bridge.morphs.inputs.input_checks import CheckedShape, CheckJob
    from ..properties.morph_inputs import CONVWASS_PG_input


# Shapes with so many faces in all are checked within a few tenths of a second.
_AT_ONCE = 50_000


class ChecksShapes(BackgroundOperator):
    """Base of operators that check shapes on the list; subclasses implement the hook at the end."""

    _title = Sentence("Checking inputs")

    def invoke(self, context, event):
        from ..bridge.morphs.inputs.input_checks import face_count

        # Only one job can show its progress, and be stopped.
        is_busy = context.window_manager.convwass_progress.running
        if is_busy or face_count(self._objects(context), context.evaluated_depsgraph_get()) <= _AT_ONCE:
            return self.execute(context)
        return BackgroundOperator.invoke(self, context, event)

    def _store(self, context: bpy.types.Context, job: CheckJob) -> None:
        """Store the results on the list, which may have changed."""
        checked = {own.obj.uid: own for own in job.checked}
        for item in self._own_scene(context).convwass_morph.inputs:
            if item.object is not None and item.object.session_uid in checked:
                _store_check(item, checked[item.object.session_uid])

    def _objects(self, context: bpy.types.Context) -> list[bpy.types.Object]:
        """Return the objects whose shapes are checked."""
        raise NotImplementedError


def mark_as_deleted(item: CONVWASS_PG_input) -> None:
    """Store on an item of the list that its object has been deleted."""
    item.verdict, item.finding = "UNUSABLE", rpt_("The object has been deleted")


def _store_check(item: CONVWASS_PG_input, checked: CheckedShape) -> None:
    """Store the result of a check on an item of the list."""
    findings = checked.findings
    if checked.error is not None:
        item.verdict, item.finding = "UNUSABLE", translated(checked.error).rstrip(".")
    elif findings is None:
        item.verdict, item.finding = "SOUND", ""
    elif not findings.has_volume and looks_flat(item.object):
        item.verdict = findings.worst
        item.finding = rpt_("It is flat: morph it with other flat shapes, or set Thickness")
    else:
        item.verdict, item.finding = findings.worst, "; ".join(_texts(findings))


def _texts(findings: ShapeFindings) -> list[str]:
    """Return the messages about a shape, the most important first."""
    if not findings.has_volume:
        return [rpt_("It encloses no volume: set Thickness, or add a Solidify modifier")]
    found = []
    if findings.open_edges:
        found.append(
            rpt_("Holes with {:d} open edges; the volume that they nearly enclose is filled").format(
                findings.open_edges
            )
        )
    if findings.flipped_faces:
        found.append(rpt_("{:d} flipped triangles; they are corrected for the morph").format(findings.flipped_faces))
    return found
