# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""New densities from painted ones: interpolated, blended, or propagated over a graph."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import BoolProperty, StringProperty

from ..bridge.densities.density_attributes import require_free
from ..bridge.densities.density_material import heat_material
from ..bridge.densities.density_player import animate_density, keys_at, takes_keys
from ..bridge.densities.density_request import path_request
from ..bridge.densities.density_store import StoredDensity, stored_or_new
from ..bridge.densities.result_groups import require_unpainted, write_result
from ..bridge.frame_range import play_among_others
from ..bridge.mesh_checks import writable_mesh
from ..bridge.morphs.stored import FIRST_FRAMES
from ..bridge.vertex_groups import group_names, read_groups, require_unlocked
from ..errors import InputError
from ..properties.densities import PathProperties, TravelProperties
from ..sentence import Sentence
from .density_job import DensityJob, slack_notices
from .density_stops import StopArguments, named_stops
from .density_targets import OnGroups
from .mesh_writing import MeshWritingOperator
from .reporting import tell

_WRITING = frozenset({"OBJECT", "PAINT_WEIGHT"})


class CONVWASS_OT_interpolate_density(PathProperties, StopArguments, MeshWritingOperator, OnGroups, bpy.types.Operator):
    """Animate a density that travels along the surface from vertex group to vertex group. The result is one animated attribute that plays without the add-on. Hidden and masked faces are included, loose vertices hold no mass, and no mass moves between connected pieces of the mesh"""  # noqa: E501

    bl_idname = "convwass.interpolate_density"
    bl_label = "Interpolate Density"
    _title = Sentence("Interpolating density")

    modes = _WRITING

    first: StringProperty(name="First", description="Vertex group that the density starts from", options={"SKIP_SAVE"})
    second: StringProperty(name="Second", description="Vertex group that the density goes to", options={"SKIP_SAVE"})
    frames: StringProperty(
        name="Frames",
        description="Scene frames in increasing order, separated by commas, one per group. Empty: the frames on the "
        "list or, without a list, consecutive frames from the start of the scene",
        options={"SKIP_SAVE"},
    )
    set_keys: BoolProperty(
        name="Set Keys",
        description="Key the arrival of the density at each group; otherwise, keys of a density of the same name are "
        "kept",
        default=True,
        options={"SKIP_SAVE"},
    )

    def _begin(self, context):
        from ..applications.densities.density_paths import path_steps

        obj = context.object
        writable_mesh(obj)
        stops = named_stops(self.chosen_stops(context, self.steps, self.frames, "", self.first, self.second))
        _require_frames(stops.frames)
        require_free(obj, self.density)
        weights, settings = read_groups(obj, stops.names), self.density_settings(self.steps)
        self._stops, self._stored = stops, path_request(obj, weights, settings, self.request(), stops.frames)
        return DensityJob(
            obj,
            settings,
            lambda surface, control: path_steps(weights, stops.names, surface, settings, stops.frames, control),
        )

    def _finish(self, context, job):
        frames, obj, stops = job.found, job.target(), self._stops
        known = stored_or_new(obj, self.density)
        description = StoredDensity(stops.names, self._stored, frames.records, outputs=known.outputs)
        set_keys = self.set_keys and takes_keys(obj, self.density)
        keys = keys_at(stops.frames) if set_keys else []
        shown = frames.covered if self.trail else frames.densities
        animate_density(obj, shown, frames.times, self.density, keys=keys, easing=self.easing, description=description)
        if self.add_material and not any(slot.material for slot in obj.material_slots):
            obj.active_material = heat_material(self.density)
        if keys:
            play_among_others(self._own_scene(context), stops.frames[0], stops.frames[-1])
        text = rpt_("{:s}: {:d} steps from frame {:g} to {:g}")
        text = text.format(self.density, len(frames.times) - 1, stops.frames[0], stops.frames[-1])
        notices = [*job.warnings, *slack_notices(frames)]
        if self.set_keys and not set_keys:
            notices.append(Sentence("Its value has a driver or locked keys, which were kept; no keys were set."))
        tell(self, text, job.remarks, notices)
        return {"FINISHED"}


def _require_frames(frames: Sequence[float]) -> None:
    """Raise InputError if a frame is outside of the frames that a scene may have."""
    last = FIRST_FRAMES[1]
    far = next((frame for frame in frames if abs(frame) > last), None)
    if far is not None:
        raise InputError(
            "The frames must lie between {first} and {last}, not at {frame:g}.", first=-last, last=last, frame=far
        )


class CONVWASS_OT_blend_densities(TravelProperties, StopArguments, MeshWritingOperator, OnGroups, bpy.types.Operator):
    """Blend vertex groups along the surface into a new group, with the weights on the list of stops. No mass moves between connected pieces of the mesh"""  # noqa: E501

    bl_idname = "convwass.blend_densities"
    bl_label = "Blend Groups"
    _title = Sentence("Blending groups")

    modes = _WRITING

    weights: StringProperty(
        name="Weights",
        description="Numbers separated by commas, one per group; empty for the weights on the list",
        options={"SKIP_SAVE"},
    )
    group: StringProperty(name="Group", description="Name of the vertex group to write", default="Blend", maxlen=63)

    def _begin(self, context):
        from ..applications.densities.density_paths import blend_steps

        obj = context.object
        writable_mesh(obj)
        require_unlocked(obj, [self.group or "Blend"])
        require_unpainted(obj, self.group or "Blend")
        stops = named_stops(self.chosen_stops(context, 1, "", self.weights))
        weights, settings = read_groups(obj, stops.names), self.density_settings()
        return DensityJob(
            obj,
            settings,
            lambda surface, control: blend_steps(weights, stops.names, stops.weights, surface, settings, control),
        )

    def _finish(self, context, job):
        from ..applications.densities.surface_densities import heat_map

        frames, obj = job.found, job.target()
        group = write_result(obj, self.group or "Blend", heat_map(frames.densities[0]).weights)
        obj.vertex_groups.active_index = group.index
        text = rpt_("The blend is in the vertex group {:s}").format(group.name)
        tell(self, text, job.remarks, [*job.warnings, *slack_notices(frames)])
        return {"FINISHED"}


class CONVWASS_OT_propagate_densities(
    TravelProperties, StopArguments, MeshWritingOperator, OnGroups, bpy.types.Operator
):
    """Fill in the stops without a group, or with an empty one, so that neighbors along the edges are as close to each other as possible; each result becomes a vertex group"""  # noqa: E501

    bl_idname = "convwass.propagate_densities"
    bl_label = "Propagate"
    _title = Sentence("Filling in groups")

    modes = _WRITING

    edges: StringProperty(
        name="Edges",
        description="Pairs of stops that should be close to each other, by their numbers from 0, such as 0-1, 1-2, "
        "1-3; empty for a chain",
        options={"SKIP_SAVE"},
    )

    def _begin(self, context):
        from ..applications.densities.density_graphs import propagation_steps

        obj = context.object
        writable_mesh(obj)
        stops = self.chosen_stops(context, 1)
        count = len(stops.names)
        names = [name or f"Place {place}" for place, name in enumerate(stops.names)]
        there = [name for name in stops.names if name in group_names(obj)]
        weights = dict(zip(there, read_groups(obj, there), strict=True)) if there else {}
        fixed = {place: weights[name] for place, name in enumerate(stops.names) if weights.get(name, _NOTHING).any()}
        if len(fixed) == count:
            raise InputError("All stops have painted groups; leave out the group of those to fill in.")
        self._filled = {place: name for place, name in enumerate(names) if place not in fixed}
        _require_distinct(list(self._filled.values()))
        _require_fillable(obj, self._filled.values())
        settings = self.density_settings()
        pairs = _pairs(self.edges or obj.convwass_density.edges) or [(n, n + 1) for n in range(count - 1)]
        return DensityJob(
            obj,
            settings,
            lambda surface, control: propagation_steps(pairs, fixed, surface, settings, names, control=control),
        )

    def _finish(self, context, job):
        from ..applications.densities.surface_densities import heat_map

        frames, obj = job.found, job.target()
        # Either all groups are written or none.
        _require_fillable(obj, self._filled.values())
        for place, name in self._filled.items():
            write_result(obj, name, heat_map(frames.densities[place]).weights)
        text = rpt_("Filled in: {:s}").format(", ".join(self._filled.values()))
        tell(self, text, job.remarks, [*job.warnings, *slack_notices(frames)])
        return {"FINISHED"}


_NOTHING = np.zeros(1)


def _require_distinct(names: Sequence[str]) -> None:
    """Raise InputError if two stops would be filled in as the same group."""
    twice = next((name for place, name in enumerate(names) if name in names[:place]), None)
    if twice is not None:
        raise InputError("Two stops would be filled in as the group {name}; give one of them another name.", name=twice)


def _require_fillable(obj: bpy.types.Object, names: Iterable[str]) -> None:
    """Raise InputError if a group to be filled in is locked or painted."""
    require_unlocked(obj, names)
    for name in names:
        require_unpainted(obj, name)


def _pairs(text: str) -> list[tuple[int, int]]:
    """Parse edges; raises InputError if the text is invalid."""
    words = [word for word in re.split(r"[,;\s]+", re.sub(r"\s*-\s*", "-", text.strip())) if word]
    found = [re.fullmatch(r"(\d{1,6})-(\d{1,6})", word, re.ASCII) for word in words]
    if not all(found):
        raise InputError("Edges must be pairs of numbers such as 0-1, 1-2, not {text!r}.", text=text)
    return [(int(pair[1]), int(pair[2])) for pair in found]


classes = (CONVWASS_OT_interpolate_density, CONVWASS_OT_blend_densities, CONVWASS_OT_propagate_densities)
