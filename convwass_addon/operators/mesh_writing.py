# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work that writes its result to a mesh, which the user may be editing."""

from __future__ import annotations

import bpy

from ..sentence import Sentence
from .background import BackgroundOperator
from .object_job import ObjectJob

# Operators that hold on to the mesh while they run.
_HOLDING_THE_MESH = ("PAINT_OT_", "SCULPT_OT_", "TRANSFORM_OT_", "MESH_OT_")


class MeshWritingOperator(BackgroundOperator):
    """Base of operators whose result waits until the mesh can be written."""

    def _waits_for(self, context: bpy.types.Context, job: ObjectJob) -> Sentence | None:
        if job.is_edited:
            return Sentence("Done; leave Edit Mode to apply the result")
        return self._waits_for_stroke(context)

    def _waits_for_stroke(self, context: bpy.types.Context) -> Sentence | None:
        """Return a message if the user is in the middle of a stroke."""
        running = getattr(context.window, "modal_operators", ())
        if any(operator.bl_idname.startswith(_HOLDING_THE_MESH) for operator in running):
            return Sentence("Done; the result is applied after this stroke")
        return None
