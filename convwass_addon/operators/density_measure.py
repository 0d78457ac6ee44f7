# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Distances along a surface: between two groups, between all groups, and from vertices."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import BoolProperty, StringProperty

from ..applications.densities.density_settings import DensitySettings
from ..bridge.densities.result_groups import require_unpainted, write_result
from ..bridge.mesh_checks import writable_mesh
from ..bridge.vertex_groups import group_names, read_groups
from ..errors import InputError
from ..progress import Control, Progress, Work
from ..properties.densities import ON_SURFACE, SurfaceProperties
from ..properties.from_schema import property_of, values_of
from ..sentence import Sentence
from .background import BackgroundOperator
from .chosen_inputs import split_names
from .density_job import DensityJob
from .density_pick import OnVertices
from .density_targets import OnGroups, OnMesh, chosen_pair
from .mesh_targets import length_text, out_of_edit_mode
from .mesh_writing import MeshWritingOperator
from .reporting import tell

if TYPE_CHECKING:
    from ..applications.densities.density_measures import DistanceTable
    from ..applications.densities.surface_densities import Surface
    from ..applications.densities.vertex_distances import VertexDistances


class CONVWASS_OT_measure_distance(SurfaceProperties, BackgroundOperator, OnGroups, bpy.types.Operator):
    """Measure the Wasserstein distance between two vertex groups along the surface, in scene units. Hidden and masked vertices are included"""  # noqa: E501

    bl_idname = "convwass.measure_distance"
    bl_label = "Measure Distance"
    _title = Sentence("Measuring")

    first: StringProperty(
        name="First", description="Vertex group; empty for the one chosen in the panel", options={"SKIP_SAVE"}
    )
    second: StringProperty(
        name="Second", description="Vertex group; empty for the one chosen in the panel", options={"SKIP_SAVE"}
    )
    debias: BoolProperty(
        name="Debias",
        description="Correct the distance for the blur, so that equal groups have distance zero; otherwise it is the "
        "raw value of eq. (10) of the paper",
        default=True,
    )

    def _begin(self, context):
        from ..applications.densities.density_measures import MEASURING_SUBSTEPS, measuring_steps

        obj = context.object
        first, second = chosen_pair(obj)
        self._names = names = self.first or first, self.second or second
        if not all(names):
            raise InputError("Choose two groups to measure.")
        pair, debias = read_groups(obj, names), self.debias
        settings = DensitySettings(**values_of(self, DensitySettings, ON_SURFACE), substeps=MEASURING_SUBSTEPS)
        match = settings.pieces == "match"
        return DensityJob(
            obj,
            settings,
            lambda surface, control: measuring_steps(
                *pair, surface, names, debias=debias, match_pieces=match, control=control
            ),
        )

    def _finish(self, context, job):
        result = job.found
        found = job.target().convwass_density_findings
        (found.first, found.second), found.distance = self._names, result.length
        length = length_text(context.scene, result.length)
        text = rpt_("From {:s} to {:s}: {:s}").format(*self._names, length)
        if not self.debias:
            text = rpt_("{:s} (eq. (10): {:.4g})").format(text, result.squared)
        tell(self, text, job.remarks, [*job.warnings, *_inexact(result.converged)])
        return {"FINISHED"}


def _inexact(converged: bool) -> list[Sentence]:
    return [] if converged else [Sentence("The distance is less exact than requested; try a larger blur.")]


class CONVWASS_OT_measure_groups(BackgroundOperator, OnGroups, bpy.types.Operator):
    """Measure the distances between all pairs of vertex groups, as a table in the Text Editor; empty groups are ignored"""  # noqa: E501

    bl_idname = "convwass.measure_groups"
    bl_label = "Measure All Groups"
    _title = Sentence("Measuring")

    groups: StringProperty(
        name="Groups",
        description="Names of vertex groups, one per line or separated by commas; empty for all groups",
        options={"SKIP_SAVE"},
    )
    blur: property_of(DensitySettings, "blur")

    def _begin(self, context):
        from ..applications.densities.density_measures import MEASURING_SUBSTEPS, distance_table_steps

        obj = context.object
        named = split_names(self.groups, group_names(obj))
        names = named or group_names(obj)
        weights = read_groups(obj, names)
        if not named:
            painted = weights.any(axis=1)
            names, weights = [name for name, own in zip(names, painted, strict=True) if own], weights[painted]
        if len(names) < 2:
            raise InputError("Measuring requires at least two groups; paint another one.")
        settings = DensitySettings(blur=self.blur or None, substeps=MEASURING_SUBSTEPS)
        return DensityJob(
            obj,
            settings,
            lambda surface, control: distance_table_steps(weights, names, surface, control=control),
        )

    def _finish(self, context, job):
        table = job.found
        obj = job.target()
        text = bpy.data.texts.new(f"{obj.name} Distances")
        text.write(_written(table))
        obj.convwass_density_findings.table = text.name
        count = len(table.names)
        warnings = [*job.warnings, *table.notices, *_inexact(table.converged)]
        message = rpt_("Distances between {:d} groups are in the text {:s}").format(count, text.name)
        tell(self, message, job.remarks, warnings)
        return {"FINISHED"}


def _written(table: DistanceTable) -> str:
    """Return a table for spreadsheets: cells separated by tabs, empty where there is no distance."""
    rows = [["", *table.names]]
    for name, lengths in zip(table.names, table.lengths, strict=True):
        rows.append([name, *(f"{length:.6g}" if np.isfinite(length) else "" for length in lengths)])
    return "".join("\t".join(row) + "\n" for row in rows)


class CONVWASS_OT_distance_from_vertices(OnVertices, MeshWritingOperator, OnMesh, bpy.types.Operator):
    """Write the distance along the surface from the selected vertices, or from a clicked point, to a vertex group. A weight of 1 is the distance of the farthest vertex. Vertices on other pieces of the mesh have weight 1 too"""  # noqa: E501

    bl_idname = "convwass.distance_from_vertices"
    bl_label = "Distance from Vertices"
    _title = Sentence("Measuring")

    group: StringProperty(name="Group", description="Name of the vertex group to write", default="Distance", maxlen=63)
    blur: property_of(DensitySettings, "blur")

    def _begin(self, context):
        from ..applications.densities.density_measures import MEASURING_SUBSTEPS

        obj = context.object
        with out_of_edit_mode(context, obj):
            writable_mesh(obj)
            require_unpainted(obj, self.group or "Distance")
            settings = DensitySettings(blur=self.blur or None, substeps=MEASURING_SUBSTEPS)
            return DensityJob(obj, settings, partial(_distances_steps, self.chosen_vertices(obj)))

    def _waits_for(self, context, job):
        # Edit Mode is left temporarily, so there is no need to wait for the user to leave it.
        return self._waits_for_stroke(context)

    def _finish(self, context, job):
        obj, found = job.target(), job.found
        shown = found.heat_map()
        with out_of_edit_mode(context, obj):
            group = write_result(obj, self.group or "Distance", shown.weights)
            obj.vertex_groups.active_index = group.index
        text = rpt_("{:s}: a weight of 1 is {:s}").format(group.name, length_text(context.scene, shown.scale))
        tell(self, text, job.remarks, found.notices)
        return {"FINISHED"}


def _distances_steps(vertices: list[int], surface: Surface, control: Control) -> Work[VertexDistances]:
    from ..applications.densities.vertex_distances import distances_from

    yield Progress(0.0, Sentence("Measuring from {count} vertices", {"count": len(vertices)}))
    return distances_from(vertices, surface, control)


classes = (CONVWASS_OT_measure_distance, CONVWASS_OT_measure_groups, CONVWASS_OT_distance_from_vertices)
