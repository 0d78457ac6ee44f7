# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Grades to reuse: a table for other programs, and nodes for the compositor."""

from __future__ import annotations

from pathlib import Path

import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import StringProperty

from ..applications.palettes.lookup_table import LookupTable, lookup_table, write_cube
from ..applications.palettes.recolor_job import recolor_steps
from ..bridge.files import checked_target
from ..bridge.palettes.grade_nodes import grade_group
from ..errors import ConvwassError, InputError
from ..recolor_properties import RecolorProperties, cube_size_property
from .density_targets import tell
from .recolor_targets import OnImage, chosen_image, image_property, read_pictures
from .reporting import refuse


class _MakesTable(RecolorProperties):
    """An operator that needs the map of colors as a table; measuring and solving take a fraction of a second."""

    def _table(self, context: bpy.types.Context) -> LookupTable:
        image = chosen_image(context, self.image)
        source, palettes, weights = read_pictures(context, image)
        steps = list(recolor_steps(source, palettes, weights, self.recolor_settings(), only_map=True))
        return lookup_table(steps[-1].change, self.cube_size)


class CONVWASS_OT_write_lut(_MakesTable, OnImage, bpy.types.Operator):
    """Write the map of colors as a .cube table, which video editors and other programs apply to whole clips"""

    bl_idname = "convwass.write_lut"
    bl_label = "Write .cube"

    image: image_property()
    cube_size: cube_size_property()
    filepath: StringProperty(
        name="File Path", description="The .cube file to write", subtype="FILE_PATH", options={"SKIP_SAVE"}
    )
    filter_glob: StringProperty(name="File Filter", default="*.cube", options={"HIDDEN"})

    def execute(self, context):
        try:
            if not self.filepath:
                raise InputError("Choose a file to write.")
            path = checked_target(Path(bpy.path.abspath(self.filepath)).with_suffix(".cube"))
            write_cube(self._table(context), path, context.scene.convwass_recolor.chosen_palettes[0][0].name)
        except ConvwassError as error:
            return refuse(self, error)
        tell(self, rpt_("Wrote {:s}").format(str(path)))
        return {"FINISHED"}

    def invoke(self, context, event):
        if not self.filepath:
            self.filepath = "//grade.cube" if bpy.data.filepath else "grade.cube"
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}


class CONVWASS_OT_build_grade_nodes(_MakesTable, OnImage, bpy.types.Operator):
    """Make a node group for the compositor that applies the map of colors to whatever comes in: add it with Add > Group"""  # noqa: E501

    bl_idname = "convwass.build_grade_nodes"
    bl_label = "Build Compositor Group"

    image: image_property()
    cube_size: cube_size_property()

    def execute(self, context):
        try:
            name = context.scene.convwass_recolor.chosen_palettes[0][0].name
            group = grade_group(self._table(context), f"Grade {name}")
        except ConvwassError as error:
            return refuse(self, error)
        tell(self, rpt_("Made the node group {:s} for the compositor").format(group.name))
        return {"FINISHED"}


classes = (CONVWASS_OT_write_lut, CONVWASS_OT_build_grade_nodes)
