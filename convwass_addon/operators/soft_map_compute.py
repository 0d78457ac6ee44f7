# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compute, repair and remove soft maps and mirror maps."""

from __future__ import annotations

from functools import partial

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import StringProperty
from numpy.typing import NDArray

from ..applications.soft_maps.soft_map_settings import SoftMapSettings
from ..applications.soft_maps.surface_maps import SurfaceMap
from ..bridge.soft_maps.mapped_meshes import equal_groups, standing_mesh
from ..bridge.soft_maps.soft_map_store import forget_soft_map, require_storable, require_storable_between
from ..bridge.vertex_places import has_vertex
from ..errors import InputError
from ..properties.soft_maps import CONVWASS_PG_soft_map, SoftMapProperties, threshold_property
from ..sentence import Sentence
from .background import BackgroundOperator
from .reporting import reporting_errors, tell
from .soft_map_job import RepairJob, SoftMapJob, Solve
from .soft_map_targets import OnMapObjects, OnStoredMap, current_way, mapped_objects, reshaped_notices

_WAYS = ("forward", "backward")


class _ComputesMap(SoftMapProperties, BackgroundOperator):
    """Base of operators that compute and store a map."""

    pairs: StringProperty(
        name="Pairs",
        description="Corresponding vertices, such as 12:40, 77:301, source first; empty for the list of pairs",
        options={"SKIP_SAVE"},
    )

    def _begin(self, context):
        own = context.scene.convwass_soft_map
        require_storable_between(own.source, own.target)
        self._pairs = chosen_pairs(own, self.pairs)
        solve = self._solver(self._pairs, self.soft_map_settings())
        return SoftMapJob(own.source, own.target, self._groups(own), solve)

    def _solver(self, pairs: NDArray[np.int64], settings: SoftMapSettings) -> Solve:
        """Return the function that computes the map; it does not access Blender's data."""
        raise NotImplementedError

    def _groups(self, own: CONVWASS_PG_soft_map) -> list[str]:
        """Return the names of the vertex groups to use."""
        return []

    def _finish(self, context, job):
        found = job.found
        source, target = job.store()
        text = rpt_("Soft map from {:s} to {:s}: {:d} pairs, {:.0%} of the vertices are doubtful")
        text = text.format(source.name, target.name, len(self._pairs), _doubtful_share(found))
        tell(self, text, job.remarks, found.notices)
        return {"FINISHED"}


def _doubtful_share(found: SurfaceMap) -> float:
    from ..applications.soft_maps.map_extension import DOUBTFUL

    confidence = found.forward.confidence
    return float((confidence < DOUBTFUL).mean()) if len(confidence) else 0.0


class CONVWASS_OT_compute_soft_map(_ComputesMap, OnMapObjects, bpy.types.Operator):
    """Find the point of the target that corresponds to each vertex of the source, and vice versa, from the pairs. The map is stored with the source and can be used for any number of transfers"""  # noqa: E501

    bl_idname = "convwass.compute_soft_map"
    bl_label = "Compute Soft Map"
    _title = Sentence("Computing soft map")

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        own = context.scene.convwass_soft_map
        if own.source == own.target:
            cls.poll_message_set("Choose two objects, or press Mirror Map for one")
            return False
        return True

    def _solver(self, pairs, settings):
        from ..applications.soft_maps.map_solving import soft_map_steps

        return lambda source, target, control: soft_map_steps(source, target, pairs, settings, control)

    def _groups(self, own):
        return equal_groups(own.source, own.target) if self.use_groups else []


def chosen_pairs(own: CONVWASS_PG_soft_map, text: str) -> NDArray[np.int64]:
    """Return the pairs given as text, or else those on the list, (k, 2).

    Raises
    ------
    InputError
        The text is invalid, or a vertex on the list is not there any more.
    """
    words = text.replace(",", " ").split()
    if words:
        return _written_pairs(words)
    own.renew()
    for number, pair in enumerate(own.pairs, start=1):
        numbers = (pair.source_vertex, pair.target_vertex)
        for obj, vertex, now in zip((own.source, own.target), numbers, own.vertices_now(pair), strict=True):
            if pair.enabled and pair.is_complete and now is None:
                raise _lost(number, obj, vertex)
    listed = [(pair.source_vertex, pair.target_vertex) for pair in own.used_pairs]
    return np.array(listed, dtype=np.int64).reshape(-1, 2)


def _lost(number: int, obj: bpy.types.Object, vertex: int) -> InputError:
    """Return the error about a pair whose vertex on an object is not there any more."""
    if has_vertex(obj, vertex):
        return InputError(
            "Pair {number} was on a part of {object} that was deleted; remove the pair, or choose it again.",
            number=number,
            object=obj.name,
        )
    return InputError(
        "Pair {number} refers to vertex {vertex}, but {object} has {count} vertices; remove the pair, or choose it "
        "again.",
        number=number,
        vertex=vertex,
        object=obj.name,
        count=len(obj.data.vertices),
    )


def _written_pairs(words: list[str]) -> NDArray[np.int64]:
    try:
        pairs = [[int(number) for number in word.split(":")] for word in words]
        return np.array(pairs, dtype=np.int64).reshape(len(words), 2)
    except ValueError as error:
        text = " ".join(words)
        raise InputError(
            "Pairs must be two vertex numbers with a colon, such as 12:40, not {text!r}.", text=text
        ) from error


class CONVWASS_OT_mirror_map(_ComputesMap, OnMapObjects, bpy.types.Operator):
    """Find the mirror image of each vertex on the same object, in any pose, from pairs of a left and a right vertex. With this map, transfers go from one side to the other"""  # noqa: E501

    bl_idname = "convwass.mirror_map"
    bl_label = "Compute Mirror Map"
    _title = Sentence("Computing mirror map")

    @classmethod
    def poll(cls, context):
        if not super().poll(context):
            return False
        own = context.scene.convwass_soft_map
        if own.source != own.target:
            cls.poll_message_set("Choose the same object as source and target")
            return False
        return True

    def _solver(self, pairs, settings):
        from ..applications.soft_maps.mirror_maps import mirror_map_steps

        return lambda side, _same, control: mirror_map_steps(side, pairs, settings, control)


class CONVWASS_OT_repair_soft_map(BackgroundOperator, OnStoredMap, bpy.types.Operator):
    """Replace the images of vertices with low confidence by those of their neighbors, in both directions; distributions are not changed"""  # noqa: E501

    bl_idname = "convwass.repair_soft_map"
    bl_label = "Repair Doubtful Regions"
    _title = Sentence("Repairing soft map")

    threshold: threshold_property()

    def _begin(self, context):
        from ..applications.soft_maps.map_repair import repaired_map

        way = current_way(context)
        require_storable(way.source)
        self._remarks = reshaped_notices(way)
        meshes = [standing_mesh(obj, way.side(obj).triangles) for obj in (way.source, way.target)]
        return RepairJob(way, partial(repaired_map, way.stored.found, *meshes, self.threshold))

    def _finish(self, context, job):
        before, found = job.before, job.found
        job.store()
        counts = [int((getattr(before, way).faces != getattr(found, way).faces).sum()) for way in _WAYS]
        text = rpt_("Filled in {:d} points from {:s} and {:d} from {:s}")
        tell(self, text.format(counts[0], job.names[0], counts[1], job.names[1]), self._remarks)
        return {"FINISHED"}


class CONVWASS_OT_remove_soft_map(OnStoredMap, bpy.types.Operator):
    """Remove the stored map between source and target; transferred data is kept"""

    bl_idname = "convwass.remove_soft_map"
    bl_label = "Remove Soft Map"

    @reporting_errors
    def execute(self, context):
        source, target = mapped_objects(context)
        require_storable(source)
        forget_soft_map(source, target)
        return {"FINISHED"}


classes = (
    CONVWASS_OT_compute_soft_map,
    CONVWASS_OT_mirror_map,
    CONVWASS_OT_repair_soft_map,
    CONVWASS_OT_remove_soft_map,
)
