# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work that ends with something written to a mesh, which the user may be editing then."""

from __future__ import annotations

import bpy

from ..sentence import Sentence
from .background import BackgroundOperator
from .object_job import ObjectJob

# While these run, Blender holds on to the mesh.
_HOLDING_THE_MESH = ("PAINT_OT_", "SCULPT_OT_", "TRANSFORM_OT_", "MESH_OT_")


class MeshWritingOperator(BackgroundOperator):
    """An operator whose result waits until the mesh can be written to."""

    _job: ObjectJob

    def _waits_for(self, context):
        if self._job.is_edited:
            return Sentence("Done; leave Edit Mode to get the result")
        return self._waits_for_stroke(context)

    def _waits_for_stroke(self, context: bpy.types.Context) -> Sentence | None:
        """Say so while the user has the mouse down."""
        running = getattr(context.window, "modal_operators", ())
        if any(operator.bl_idname.startswith(_HOLDING_THE_MESH) for operator in running):
            return Sentence("Done; the result comes after this stroke")
        return None
