# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators on painted densities: normalize, diffuse, sharpen, drop mass."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import EnumProperty, FloatProperty
from numpy.typing import NDArray

from ..applications.densities.density_settings import DensitySettings
from ..bridge.mesh_checks import writable_mesh
from ..bridge.vertex_groups import read_group, write_group
from ..progress import Control, Progress, Work
from ..properties.densities import length_property, radius_property, share_property
from ..sentence import Sentence
from .density_job import DensityJob
from .density_pick import OnVertices
from .density_targets import OnGroups, OnMesh, chosen_group, group_property
from .mesh_targets import length_text, out_of_edit_mode
from .mesh_writing import MeshWritingOperator
from .reporting import tell

if TYPE_CHECKING:
    from ..applications.densities.surface_densities import Surface

# Default diffusion length, as a share of the width of the surface.
_USUAL_SPREAD = 0.05
# Share of the maximum below which a vertex is not counted as covered.
_VISIBLE = 0.01


@dataclass(frozen=True)
class _Painted:
    """A changed density and its figures."""

    density: NDArray[np.float64]
    covered: float
    radius: float
    entropy: float


class _PaintDensity(MeshWritingOperator):
    """Base of operators that replace the weights of a group."""

    _title = Sentence("Painting")

    def _begin(self, context):
        obj = context.object
        with out_of_edit_mode(context, obj):
            writable_mesh(obj)
            self._name = self._name_of_group(obj)
            return DensityJob(obj, DensitySettings(), partial(_steps, self._name, self._change(obj, self._name)))

    def _name_of_group(self, obj: bpy.types.Object) -> str:
        return chosen_group(obj, self.group)

    def _change(self, obj: bpy.types.Object, name: str) -> Callable[[Surface, Control], NDArray[np.float64]]:
        """Return a function that computes the new density of the group, (n,), without accessing Blender's data."""
        raise NotImplementedError

    def _waits_for(self, context, job):
        # Edit Mode is left temporarily, so there is no need to wait for the user to leave it.
        return self._waits_for_stroke(context)

    def _finish(self, context, job):
        """Write the group, report its figures and show them in the panel."""
        from ..applications.densities.surface_densities import heat_map

        obj, painted = job.target(), job.found
        with out_of_edit_mode(context, obj):
            group = write_group(obj, self._name, heat_map(painted.density).weights)
            obj.vertex_groups.active_index = group.index
        found = obj.convwass_density_findings
        found.group, found.covered = self._name, painted.covered
        found.radius, found.entropy = painted.radius, painted.entropy
        text = rpt_("{:s} covers {:.1%} of the surface, radius {:s}, entropy {:.2f}")
        radius = length_text(context.scene, painted.radius)
        tell(self, text.format(self._name, painted.covered, radius, painted.entropy), job.remarks)
        return {"FINISHED"}


def _steps(
    name: str, change: Callable[[Surface, Control], NDArray[np.float64]], surface: Surface, control: Control
) -> Work[_Painted]:
    from ..applications.densities.surface_densities import density_figures

    message = Sentence("Changing {name}", {"name": name})
    yield Progress(0.0, message)
    density = change(surface, control)
    figures = density_figures(density, surface, name)
    # Diffusion leaves some heat everywhere, too little to be visible.
    visible = np.where(density >= _VISIBLE * density.max(), density, 0.0)
    covered = density_figures(visible, surface, name).covered
    return _Painted(density, covered, figures.radius, figures.entropy)


class CONVWASS_OT_normalize_density(_PaintDensity, OnGroups, bpy.types.Operator):
    """Normalize a vertex group to a distribution: its heat map has a maximum of 1, and loose vertices, which have no area, lose their weight. Hidden and masked vertices are included"""  # noqa: E501

    bl_idname = "convwass.normalize_density"
    bl_label = "Normalize"

    group: group_property()

    def _change(self, obj, name):
        from ..applications.densities.surface_densities import distribution

        weights = read_group(obj, name)
        return lambda surface, control: distribution(weights, surface, name)


class CONVWASS_OT_diffuse_density(_PaintDensity, OnGroups, bpy.types.Operator):
    """Diffuse a vertex group along the surface by the heat equation, also over hidden and masked vertices, but not between connected pieces of the mesh"""  # noqa: E501

    bl_idname = "convwass.diffuse_density"
    bl_label = "Diffuse"

    group: group_property()
    length: length_property()

    def _change(self, obj, name):
        from ..applications.densities.density_tools import diffused

        weights, length = read_group(obj, name), self.length
        return lambda surface, control: diffused(
            weights, surface, length or _USUAL_SPREAD * surface.unit_length, name, control
        )


class CONVWASS_OT_sharpen_density(_PaintDensity, OnGroups, bpy.types.Operator):
    """Concentrate a vertex group around its peaks; each connected piece of the mesh keeps its share"""

    bl_idname = "convwass.sharpen_density"
    bl_label = "Sharpen"

    group: group_property()
    to: EnumProperty(
        name="To",
        description="Target of the sharpening",
        items=(
            ("SHARE", "Share", "The share of the area that the density covers"),
            ("ENTROPY", "Entropy", "The entropy in nats"),
        ),
    )
    share: share_property()
    entropy: FloatProperty(
        name="Entropy",
        description="Entropy of the result in nats; 0 is a uniform density, lower is sharper",
        default=-2.0,
    )

    def _change(self, obj, name):
        from ..applications.densities.density_tools import sharpened, sharpened_by

        weights, share, limit = read_group(obj, name), self.share, self.entropy
        if self.to == "SHARE":
            return lambda surface, control: sharpened_by(weights, surface, share, name, control)
        return lambda surface, control: sharpened(weights, surface, limit, name, control)


class CONVWASS_OT_drop_density(OnVertices, _PaintDensity, OnMesh, bpy.types.Operator):
    """Drop a unit mass on the selected vertices, or on a clicked point of the surface"""

    bl_idname = "convwass.drop_density"
    bl_label = "Drop Mass"

    group: group_property()
    radius: radius_property()
    share: FloatProperty(
        name="Share",
        description="Share of the group's mass that is replaced by the dropped mass; at 1 all of it",
        default=1.0,
        min=0.01,
        max=1.0,
        subtype="FACTOR",
    )

    def _name_of_group(self, obj):
        return self.group or (chosen_group(obj, "") if obj.vertex_groups.active else "Mass")

    def _change(self, obj, name):
        from ..applications.densities.density_tools import diffused, unit_mass
        from ..applications.densities.surface_densities import distribution

        weights = read_group(obj, name) if name in obj.vertex_groups else np.zeros(len(obj.data.vertices))
        vertices, radius, share = self.chosen_vertices(obj), self.radius, self.share

        def changed(surface: Surface, control: Control) -> NDArray[np.float64]:
            dropped = unit_mass(vertices, surface)
            if radius > 0.0:
                dropped = diffused(dropped, surface, radius, name, control)
            if share == 1.0 or not weights.any():
                return dropped
            return share * dropped + (1.0 - share) * distribution(weights, surface, name)

        return changed


classes = (
    CONVWASS_OT_normalize_density,
    CONVWASS_OT_diffuse_density,
    CONVWASS_OT_sharpen_density,
    CONVWASS_OT_drop_density,
)
