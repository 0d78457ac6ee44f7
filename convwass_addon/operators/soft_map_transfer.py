# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Transfer vertex groups, shape keys, UV maps and color attributes with a stored soft map."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_iface as iface_, pgettext_rpt as rpt_
from bpy.props import StringProperty

from ..bridge.color_attributes import color_names
from ..bridge.mesh_checks import writable_mesh
from ..bridge.soft_maps.carried_groups import CarriedGroups
from ..bridge.soft_maps.map_shape_keys import key_names
from ..bridge.soft_maps.map_transfer import CarriedPart, TransferEnds, all_carried, require_names
from ..bridge.soft_maps.mapped_meshes import resting_mesh
from ..bridge.soft_maps.soft_map_requests import TransferRequest
from ..bridge.uv_maps import uv_names
from ..bridge.vertex_groups import group_names
from ..errors import InputError
from ..progress import UNINTERRUPTED, Control, Progress, Work
from ..properties.from_schema import values_of
from ..properties.soft_maps import TRANSFERRED, TransferProperties
from ..sentence import Sentence, first_names
from .chosen_inputs import split_names
from .mesh_writing import MeshWritingOperator
from .object_job import ObjectJob
from .reporting import tell
from .soft_map_job import require_same_mesh
from .soft_map_targets import OnStoredMap, StoredWay, current_way, edit_mode_left, reshaped_notices

# The names of the data of every kind.
_NAMES = {"GROUPS": group_names, "KEYS": key_names, "UVS": uv_names, "COLORS": color_names}


class TransferJob(ObjectJob):
    """Transfers some kinds of data. All methods except :meth:`steps` must be called on the main thread.

    Parameters
    ----------
    way : StoredWay
        The map.
    receiver : bpy.types.Object
        The object to write to.
    parts : dict of str to part
        The data to transfer, by identifiers of `TRANSFERRED`.
    """

    def __init__(self, way: StoredWay, receiver: bpy.types.Object, parts: dict[str, CarriedPart]) -> None:
        gone = InputError("The object was deleted, or its creation undone, during the transfer; start again.")
        super().__init__(receiver, gone)
        self.parts, self._side = parts, way.side(receiver)

    def steps(self, control: Control = UNINTERRUPTED) -> Work[None]:
        """Compute all transfers."""
        yield from all_carried(self.parts.values(), control)
        yield Progress(1.0, Sentence("Writing"))

    def discard(self) -> None:
        """Discard the results."""
        self.parts = {}

    def target(self) -> bpy.types.Object:
        """Return the object to write to; raises InputError if it was deleted, is being edited, or has changed."""
        obj = super().target()
        writable_mesh(obj)
        require_same_mesh(obj, self._side)
        return obj


class CONVWASS_OT_transfer_by_map(TransferProperties, MeshWritingOperator, OnStoredMap, bpy.types.Operator):
    """Transfer vertex groups, shape keys, UV maps or color attributes from one object to the other with the stored soft map"""  # noqa: E501

    bl_idname = "convwass.transfer_by_map"
    bl_label = "Transfer"
    _title = Sentence("Transferring")

    names: StringProperty(
        name="Names",
        description="Names of the data to transfer, one per line or separated by commas; empty for all",
        options={"SKIP_SAVE"},
    )

    def _begin(self, context):
        own = context.scene.convwass_soft_map
        if not self.what:
            raise InputError("Choose what to transfer.")
        way = current_way(context)
        giver, receiver = (own.source, own.target) if self.direction == "FORWARD" else (own.target, own.source)
        writable_mesh(receiver)
        if giver == receiver and self.what & {"UVS", "COLORS"}:
            raise InputError(
                "{object} cannot receive UV maps or color attributes from itself; choose vertex groups or shape keys.",
                object=giver.name,
            )
        self._remarks = reshaped_notices(way)
        # Attributes cannot be read in Edit Mode.
        with edit_mode_left(context):
            known = [name for kind, *_ in TRANSFERRED if kind in self.what for name in _NAMES[kind](giver)]
            names = split_names(self.names, known)
            require_names(giver, known, names)
            meshes = [resting_mesh(obj, way.side(obj).triangles) for obj in (giver, receiver)]
            request = TransferRequest(**values_of(self, TransferRequest))
            ends = TransferEnds(giver, receiver, way.point_map(receiver), *meshes, tuple(names), request)
            return TransferJob(way, receiver, self._parts(ends))

    def _parts(self, ends: TransferEnds) -> dict[str, CarriedPart]:
        from ..bridge.soft_maps.carried_keys import CarriedKeys
        from ..bridge.soft_maps.carried_layers import CarriedColors, CarriedUvs

        makers = {"GROUPS": CarriedGroups, "KEYS": CarriedKeys, "UVS": CarriedUvs, "COLORS": CarriedColors}
        # In the order of the panel.
        return {kind: makers[kind](ends) for kind, *_ in TRANSFERRED if kind in self.what}

    def _finish(self, context, job):
        receiver = job.target()
        # Another object may be in Edit Mode, in which Blender cannot write groups.
        with edit_mode_left(context):
            carried = {kind: part.write(receiver) for kind, part in job.parts.items()}
        labels = {kind: iface_(label) for kind, label, _ in TRANSFERRED}
        counts = [f"{labels[kind]} {len(done.written)}" for kind, done in carried.items()]
        text = rpt_("Transferred to {:s}: {:s}").format(receiver.name, ", ".join(counts))
        kept = [name for done in carried.values() for name in done.kept]
        remarks = [Sentence("Not overwritten: {names}.", {"names": first_names(kept)})] if kept else []
        warnings = [*self._remarks, *(notice for done in carried.values() for notice in done.notices)]
        tell(self, text, remarks, warnings)
        return {"FINISHED"}


classes = (CONVWASS_OT_transfer_by_map,)
