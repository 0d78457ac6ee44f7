# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Fit an armature into a body in the background: pinned joints keep their positions, the others are placed inside."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ..applications.skeletons.skeleton_settings import SkeletonSettings
from ..bridge.armatures.auto_weights import bind_with_weights, require_bindable
from ..bridge.armatures.rig_graphs import RigGraph
from ..bridge.handles import Handle
from ..errors import InputError
from ..progress import UNINTERRUPTED, Control, Work
from ..properties.armatures import FitProperties, chosen_rig
from ..sentence import Sentence
from .armature_targets import OnBody
from .background import Job
from .mesh_writing import MeshWritingOperator
from .reporting import tell

if TYPE_CHECKING:
    from ..applications.skeletons.skeleton_fit import FittedSkeleton


class FitJob(Job):
    """A fit. All methods except :meth:`steps` must be called on the main thread.

    Parameters
    ----------
    body, rig : bpy.types.Object
        The mesh, and the armature fitted into it.
    graph : RigGraph
        The joints of the rig.
    settings : SkeletonSettings
        Settings of the fit.

    Raises
    ------
    InputError
        The body is not a mesh, or has no surface.
    """

    def __init__(
        self,
        body: bpy.types.Object,
        rig: bpy.types.Object,
        graph: RigGraph,
        settings: SkeletonSettings,
    ) -> None:
        from ..bridge.armatures.rigs import resting_body

        self.graph = graph
        self._body, self._rig = Handle.of("objects", body), Handle.of("objects", rig)
        self._mesh, self._settings = resting_body(body, rig, bpy.context.evaluated_depsgraph_get()), settings
        self.found: FittedSkeleton | None = None

    def steps(self, control: Control = UNINTERRUPTED) -> Work[None]:
        """Compute the fit and keep the result."""
        from ..applications.skeletons.skeleton_fit import fit_steps

        self.found = yield from fit_steps(self._mesh, self.graph.graph, self._settings, control)

    def discard(self) -> None:
        """Discard the result."""
        self.found = None

    def objects(self) -> tuple[bpy.types.Object, bpy.types.Object]:
        """Return body and rig; raises InputError if one of them was deleted."""
        body, rig = self._body.find(), self._rig.find()
        if body is None or rig is None:
            raise InputError(
                "The body or the armature was deleted, or its creation undone, during the fit; start again."
            )
        return body, rig

    @property
    def edited(self) -> set[str]:
        """Names of those of the two objects that are in Edit Mode."""
        return {obj.name for obj in (self._body.find(), self._rig.find()) if obj is not None and obj.mode == "EDIT"}

    @property
    def rig_name(self) -> str:
        """The name of the rig; empty if it was deleted."""
        rig = self._rig.find()
        return "" if rig is None else rig.name


class CONVWASS_OT_fit_armature(FitProperties, MeshWritingOperator, OnBody, bpy.types.Operator):
    """Move the unpinned joints of the armature into the body. Names, parents, connections, constraints and weights are kept, bones keep the proportions of their lengths, and their roll turns with them"""  # noqa: E501

    bl_idname = "convwass.fit_armature"
    bl_label = "Fit Armature"
    _title = Sentence("Fitting armature")

    def _begin(self, context):
        from ..bridge.armatures.rigs import require_movable, rig_graph

        rig, body = chosen_rig(context), context.scene.convwass_armature.body
        context.view_layer.update()
        require_movable(rig)
        if self.auto_weights:
            _require_bindable(body, rig)
        graph = rig_graph(rig, only_deforming=self.bones == "DEFORM")
        if not graph.graph.pinned.any():
            raise InputError(
                "No joint of {object} is pinned. Select the ends of limbs in Edit Mode, move them into place and "
                "press Pin Joints, or press Place Joints and click on the body.",
                object=rig.name,
            )
        graph.require_pins_apart()
        return FitJob(body, rig, graph, self.skeleton_settings())

    def _waits_for(self, context, job):
        edited = job.edited
        in_the_way = context.mode.startswith("EDIT") and job.rig_name not in edited
        if in_the_way or (self.auto_weights and edited):
            return Sentence("Done; leave Edit Mode to apply the result")
        return self._waits_for_stroke(context)

    def _finish(self, context, job):
        from ..bridge.armatures.fit_notices import posed_notice, short_notice, unweighted_notice
        from ..bridge.armatures.rigs import move_joints, require_movable

        body, rig = job.objects()
        found = job.found
        require_movable(rig)
        if self.auto_weights:
            _require_bindable(body, rig)
        short = move_joints(rig, job.graph, found.positions)
        warnings = [*found.notices, *short_notice(short)]
        if self.auto_weights:
            warnings += unweighted_notice(bind_with_weights(body, rig), body)
        text = rpt_("{:s} fitted into {:s}: {:d} of {:d} joints are inside")
        inside = int(found.inside.sum())
        tell(self, text.format(rig.name, body.name, inside, len(found.inside)), posed_notice(rig), warnings)
        return {"FINISHED"}


def _require_bindable(body: bpy.types.Object, rig: bpy.types.Object) -> None:
    """Raise InputError if the objects cannot be bound with weights in their modes."""
    require_bindable(body, rig)
    if rig.mode == "EDIT":
        raise InputError("{object} is in Edit Mode; leave it with Tab, then try again.", object=rig.name)


classes = (CONVWASS_OT_fit_armature,)
