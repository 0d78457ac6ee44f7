# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reusable color maps: a .cube table for other programs, and nodes for the compositor."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import StringProperty

from ..applications.palettes.palette_settings import TableSettings
from ..applications.whole_paths import path_with_suffix
from ..bridge.files.output_paths import absolute_path, checked_target
from ..bridge.handles import Handle
from ..bridge.palettes.image_kinds import is_clip
from ..errors import InputError
from ..properties.from_schema import property_of
from ..properties.recolor import RecolorProperties
from ..sentence import Sentence
from .background import BackgroundOperator
from .recolor_clip import ClipJob
from .recolor_image import RecolorJob
from .recolor_table import CubeFile, TableJob
from .recolor_targets import OnImage, chosen_image, image_property, palette_names, read_palettes, read_pictures
from .reporting import tell

if TYPE_CHECKING:
    from ..applications.palettes.lookup_table import LookupTable


class _MakesTable(RecolorProperties, BackgroundOperator, OnImage):
    """Base of operators that need the color map as a table; the map of a clip comes from all of its frames."""

    _title = Sentence("Matching palettes")

    _source: Handle
    _palette: str

    def _begin(self, context):
        from ..bridge.palettes.clip_frames import ClipFrames

        image, settings = chosen_image(context, self.image), self.recolor_settings()
        self._source, self._palette = Handle.of("images", image), next(iter(palette_names(context)), "")
        if is_clip(image):
            frames = ClipFrames(image, context.scene.convwass_recolor.mask)
            job = ClipJob(frames, *read_palettes(context), settings)
        else:
            job = RecolorJob(Handle.of("images", image), *read_pictures(context, image), settings, ends="map")
        return TableJob(job, self.cube_size, self._target())

    def _finish(self, context, job):
        job.keep()
        self._use(job.table)
        return {"FINISHED"}

    def _target(self) -> CubeFile | None:
        """Return the file to write the table to, if any."""
        return None

    def _use(self, table: LookupTable) -> None:
        """Use the table, and report the result."""
        raise NotImplementedError


class CONVWASS_OT_write_cube(_MakesTable, bpy.types.Operator):
    """Write the color map as a .cube table, which video editors and other programs can apply to whole clips"""

    bl_idname = "convwass.write_cube"
    bl_label = "Write .cube"

    image: image_property()
    cube_size: property_of(TableSettings, "cube_size")
    filepath: StringProperty(
        name="File Path",
        description="The .cube file to write",
        subtype="FILE_PATH",
        options={"SKIP_SAVE", "PATH_SUPPORTS_BLEND_RELATIVE"},
    )
    filter_glob: StringProperty(name="File Filter", default="*.cube", options={"HIDDEN"})

    _chosen_in_browser = False

    def invoke(self, context, event):
        if not self.filepath:
            self.filepath = "//grade.cube" if bpy.data.filepath else "grade.cube"
        self._chosen_in_browser = True
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context):
        # The file browser calls execute, where other operators are invoked.
        return super().invoke(context, None) if self._chosen_in_browser else super().execute(context)

    def _begin(self, context):
        if not self.filepath:
            raise InputError("Choose a file to write.")
        self._path = checked_target(path_with_suffix(absolute_path(self.filepath), ".cube"))
        return super()._begin(context)

    def _target(self):
        return CubeFile(self._path, self._palette)

    def _use(self, table):
        tell(self, rpt_("Wrote {:s}").format(str(self._path)))


class CONVWASS_OT_build_grade_nodes(_MakesTable, bpy.types.Operator):
    """Create a node group for the compositor that applies the color map: add it with Add > Group. The next group for the same image and palette replaces it"""  # noqa: E501

    bl_idname = "convwass.build_grade_nodes"
    bl_label = "Build Compositor Group"

    image: image_property()
    cube_size: property_of(TableSettings, "cube_size")

    def _use(self, table):
        from ..bridge.palettes.grade_nodes import grade_group

        group = grade_group(table, f"Grade {self._palette}", self._source.find())
        tell(self, rpt_("Made the node group {:s} for the compositor").format(group.name))


classes = (CONVWASS_OT_write_cube, CONVWASS_OT_build_grade_nodes)
