# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tools on painted densities: make a distribution of a group, spread it, sharpen it, drop mass on it."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import EnumProperty, FloatProperty
from numpy.typing import NDArray

from ..applications.density_tools import diffused, sharpened, sharpened_by, unit_mass
from ..applications.surface_densities import Surface, density_figures, density_surface, distribution, heat_map
from ..bridge.mesh_checks import writable_mesh
from ..bridge.surfaces import read_surface
from ..bridge.vertex_groups import read_group, write_group
from ..errors import ConvwassError
from ..sentence import Sentence
from .density_pick import OnVertices
from .density_targets import (
    OnGroups,
    OnMesh,
    chosen_group,
    group_property,
    ignored_notice,
    length_text,
    out_of_edit_mode,
    tell,
)
from .reporting import refuse

# Of the surface's width: what a density is spread by where no length is given.
_USUAL_SPREAD = 0.05
# Of the largest weight: less is not counted as covered.
_VISIBLE = 0.01


@dataclass(frozen=True)
class _Painted:
    """A group of an object, and the surface it is painted on."""

    object: bpy.types.Object
    name: str
    surface: Surface
    remarks: list[Sentence]

    @property
    def weights(self) -> NDArray[np.float64]:
        """Weights of all vertices, (n,); raises InputError where there is no such group."""
        return read_group(self.object, self.name)


class _PaintDensity:
    """A tool that replaces the weights of one group."""

    def execute(self, context):
        obj = context.object
        try:
            with out_of_edit_mode(context, obj):
                writable_mesh(obj)
                reading = read_surface(obj, context.evaluated_depsgraph_get())
                name = self._name_of_group(obj)
                painted = _Painted(obj, name, density_surface(reading.mesh), ignored_notice(reading.ignored))
                density = self._changed(painted)
                group = write_group(obj, name, heat_map(density).weights)
                obj.vertex_groups.active_index = group.index
                self._tell(context, painted, density)
        except ConvwassError as error:
            return refuse(self, error)
        return {"FINISHED"}

    def _name_of_group(self, obj: bpy.types.Object) -> str:
        return chosen_group(obj, self.group)

    def _changed(self, painted: _Painted) -> NDArray[np.float64]:
        """Return the new density of the group, (n,)."""
        raise NotImplementedError

    def _tell(self, context: bpy.types.Context, painted: _Painted, density: NDArray[np.float64]) -> None:
        """Report the figures of a density, and let the panel show them."""
        figures = density_figures(density, painted.surface, painted.name)
        # Heat is everywhere at once, though nobody sees it.
        visible = np.where(density >= _VISIBLE * density.max(), density, 0.0)
        covered = density_figures(visible, painted.surface, painted.name).covered
        found = painted.object.convwass_density_findings
        found.group, found.covered = painted.name, covered
        found.radius, found.entropy = figures.radius, figures.entropy
        text = rpt_("{:s} covers {:.1%} of the surface, radius {:s}, entropy {:.2f}")
        radius = length_text(context.scene, figures.radius)
        tell(self, text.format(painted.name, covered, radius, figures.entropy), painted.remarks)


class CONVWASS_OT_normalize_density(_PaintDensity, OnGroups, bpy.types.Operator):
    """Make a distribution of a vertex group: its heat map gets a maximum of 1, and loose vertices, which have no area, lose their weight. Hidden and masked vertices count like all others"""  # noqa: E501

    bl_idname = "convwass.normalize_density"
    bl_label = "Normalize"

    group: group_property()

    def _changed(self, painted):
        return distribution(painted.weights, painted.surface, painted.name)


class CONVWASS_OT_diffuse_density(_PaintDensity, OnGroups, bpy.types.Operator):
    """Let a vertex group spread by heat along the surface, also over hidden and masked vertices, but never from one connected piece of the mesh to another"""  # noqa: E501

    bl_idname = "convwass.diffuse_density"
    bl_label = "Diffuse"

    group: group_property()
    length: FloatProperty(
        name="Length",
        description="Standard deviation that the density gains along the surface; 0 takes a twentieth of the surface's "
        "width",
        default=0.0,
        min=0.0,
        soft_max=1.0,
        subtype="DISTANCE",
    )

    def _changed(self, painted):
        length = self.length or _USUAL_SPREAD * painted.surface.unit_length
        return diffused(painted.weights, painted.surface, length, painted.name)


class CONVWASS_OT_sharpen_density(_PaintDensity, OnGroups, bpy.types.Operator):
    """Gather a vertex group around its peaks; each connected piece of the mesh keeps its share"""

    bl_idname = "convwass.sharpen_density"
    bl_label = "Sharpen"

    group: group_property()
    to: EnumProperty(
        name="To",
        description="How far to sharpen",
        items=(
            ("SHARE", "Share", "To a share of the area that the density covers"),
            ("ENTROPY", "Entropy", "To an entropy in nats"),
        ),
    )
    share: FloatProperty(
        name="Share",
        description="Share of its area that the density covers afterwards",
        default=0.5,
        min=0.01,
        max=1.0,
        subtype="FACTOR",
    )
    entropy: FloatProperty(
        name="Entropy",
        description="Entropy afterwards, in nats; 0 covers the whole surface evenly, less is sharper",
        default=-2.0,
    )

    def _changed(self, painted):
        if self.to == "SHARE":
            return sharpened_by(painted.weights, painted.surface, self.share, painted.name)
        return sharpened(painted.weights, painted.surface, self.entropy, painted.name)


class CONVWASS_OT_drop_mass(OnVertices, _PaintDensity, OnMesh, bpy.types.Operator):
    """Drop a unit mass on the selected vertices, or where the surface is clicked on"""

    bl_idname = "convwass.drop_mass"
    bl_label = "Drop Mass"

    group: group_property()
    radius: FloatProperty(
        name="Radius",
        description="Length by which a dropped mass is spread along the surface; 0 leaves it on the vertices alone",
        default=0.0,
        min=0.0,
        soft_max=1.0,
        subtype="DISTANCE",
    )
    share: FloatProperty(
        name="Share",
        description="Share of the group's mass that is dropped; the rest stays as it is painted, and at 1 nothing does",
        default=1.0,
        min=0.01,
        max=1.0,
        subtype="FACTOR",
    )

    def _name_of_group(self, obj):
        return self.group or (chosen_group(obj, "") if obj.vertex_groups.active else "Mass")

    def _changed(self, painted):
        dropped = unit_mass(self.chosen_vertices(painted.object), painted.surface)
        if self.radius > 0.0:
            dropped = diffused(dropped, painted.surface, self.radius, painted.name)
        is_there = painted.name in painted.object.vertex_groups
        if self.share == 1.0 or not is_there or not painted.weights.any():
            return dropped
        kept = distribution(painted.weights, painted.surface, painted.name)
        return self.share * dropped + (1.0 - self.share) * kept


classes = (
    CONVWASS_OT_normalize_density,
    CONVWASS_OT_diffuse_density,
    CONVWASS_OT_sharpen_density,
    CONVWASS_OT_drop_mass,
)
