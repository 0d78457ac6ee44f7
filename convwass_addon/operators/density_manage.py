# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators on an animated density: bake, show, update, remove."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty, StringProperty
from numpy.typing import NDArray

from ..applications.densities.density_settings import DensitySettings
from ..bridge.densities.density_attributes import stored_frames
from ..bridge.densities.density_material import growth_material, heat_material
from ..bridge.densities.density_nodes import color_name
from ..bridge.densities.density_outputs import show_heat_colors, write_step_colors, write_step_groups
from ..bridge.densities.density_player import density_modifier, remove_density
from ..bridge.densities.density_request import DensityRequest
from ..bridge.densities.density_store import StoredDensity, stored_density
from ..bridge.mesh_checks import writable_mesh
from ..bridge.operator_errors import reason
from ..errors import ConvwassError, InputError
from ..progress import UNINTERRUPTED, Control, Progress, Work
from ..properties.densities import OutputProperties
from ..properties.from_schema import arguments_of
from ..sentence import Sentence, first_names
from .background import BackgroundOperator
from .density_changes import changed_inputs
from .density_targets import OnDensity, chosen_density, density_property
from .object_job import ObjectJob
from .reporting import refuse, reporting_errors, tell

if TYPE_CHECKING:
    from ..bridge.densities.density_images import ImageSettings


class _BakeJob(ObjectJob):
    """Writes step by step on the main thread; can be stopped in between."""

    def __init__(self, obj: bpy.types.Object, writer: Iterator[str], total: int) -> None:
        gone = ConvwassError("The object was deleted, or its creation undone, during the bake; start again.")
        super().__init__(obj, gone)
        self._writer, self._total = writer, total
        self.made: list[str] = []

    def steps(self, control: Control = UNINTERRUPTED) -> Work[None]:
        """Write all steps; raises ConvwassError if the object was deleted."""
        for number in range(1, self._total + 1):
            message = Sentence("Writing {done} of {total}", {"done": number, "total": self._total})
            yield Progress((number - 1) / self._total, message)
            control.check()
            self.target()
            self.made.append(next(self._writer))

    def discard(self) -> None:
        """Do nothing: `steps` writes each output as a whole."""


class _ImagesJob(_BakeJob):
    """Writes the steps of a density as images."""

    def __init__(self, obj: bpy.types.Object, name: str, settings: ImageSettings, folder: str) -> None:
        from ..bridge.densities.density_images import write_step_images

        frames = stored_frames(obj, name)
        super().__init__(obj, map(str, write_step_images(obj, frames, folder, name, settings)), len(frames))
        self._name = name

    def remember(self) -> list[str]:
        """Store the paths of the images with the object; return the names of others in the folder, of earlier bakes."""
        from ..bridge.densities.density_images import remember_images

        made = [Path(path) for path in self.made]
        left = remember_images(self.target(), self._name, made)
        return [path.name for path in left if path.parent == made[0].parent]

    def folder(self) -> str:
        """Return the folder of the images written so far."""
        return str(Path(self.made[0]).parent)

    def discard(self) -> None:
        """Keep the images written so far, which are complete, unless the object was deleted."""
        if self.made:
            with suppress(ConvwassError):
                self.remember()


class CONVWASS_OT_bake_density(OutputProperties, BackgroundOperator, OnDensity, bpy.types.Operator):
    """Write the steps of an animated density to vertex groups, color attributes or images, for other programs"""

    bl_idname = "convwass.bake_density"
    bl_label = "Bake Density"
    _title = Sentence("Baking density")
    _in_turn = True

    density: density_property()
    uv_map: StringProperty(
        name="UV Map", description="Name of the UV map for images; empty for the active render UV map"
    )

    def _begin(self, context):
        from ..bridge.densities.density_images import ImageSettings

        obj = context.object
        self._name = chosen_density(obj, self.density)
        density_modifier(obj, self._name)
        writable_mesh(obj)
        frames = stored_frames(obj, self._name)
        if not len(frames):
            raise InputError(
                "The frames of {name} in {object} are missing; interpolate it again.", object=obj.name, name=self._name
            )
        if self.output != "IMAGES":
            return _BakeJob(obj, self._at_once(obj, frames), 1)
        settings = ImageSettings(self.size, self.margin, self.file_format, self.uv_map)
        return _ImagesJob(obj, self._name, settings, self.folder)

    def _at_once(self, obj: bpy.types.Object, frames: NDArray[np.float32]) -> Iterator[str]:
        """Write everything in one step, and yield the message."""
        name = self._name
        if self.output == "GROUPS":
            made = write_step_groups(obj, frames, name)
            yield rpt_("{:d} vertex groups, from {:s} to {:s}").format(len(made), made[0], made[-1])
        elif self.output == "COLORS":
            made = write_step_colors(obj, frames, name)
            yield rpt_("{:d} color attributes, from {:s} to {:s}").format(len(made), made[0], made[-1])
        else:
            show_heat_colors(obj, name)
            text = rpt_("{:s} contains the heat map; set the color in Viewport Shading to Attribute to see it")
            yield text.format(color_name(name))

    def _finish(self, context, job):
        if self.output == "IMAGES":
            from ..bridge.densities.density_images import kept_files_notices

            notices = [
                *kept_files_notices(self.folder, [Path(path) for path in job.made]),
                *_left_notice(job.remember()),
            ]
            tell(self, rpt_("{:d} images in {:s}").format(len(job.made), job.folder()), notices)
        else:
            self.report({"INFO"}, job.made[0])
        return {"FINISHED"}

    def _keep(self, context, job):
        if self.output != "IMAGES" or not job.made:
            return False
        job.remember()
        text = rpt_("Stopped; {:d} images are in {:s}").format(len(job.made), job.folder())
        self.report({"WARNING"}, text)
        return True


def _left_notice(left: Sequence[str]) -> list[Sentence]:
    """Return a notice about images of an earlier bake in the same folder, which a viewer would show, too."""
    if not left:
        return []
    return [Sentence("The folder also contains images of an earlier bake: {files}.", {"files": first_names(left)})]


class CONVWASS_OT_remove_density(OnDensity, bpy.types.Operator):
    """Remove an animated density with its modifier, keys and frames; painted and baked vertex groups are kept"""

    bl_idname = "convwass.remove_density"
    bl_label = "Remove Density"

    density: density_property()

    @reporting_errors
    def execute(self, context):
        remove_density(context.object, chosen_density(context.object, self.density))
        return {"FINISHED"}


class CONVWASS_OT_show_density_material(OnDensity, bpy.types.Operator):
    """Assign a material that shows an animated density to the active material slot, or to a new one"""

    bl_idname = "convwass.show_density_material"
    bl_label = "Show Density"

    density: density_property()
    kind: EnumProperty(
        name="Kind",
        description="How the density is shown",
        items=(
            ("HEAT", "Heat Map", "From dark to bright with increasing density"),
            ("MOSS", "Moss", "Moss grows where the density is high"),
            ("FROST", "Frost", "Frost grows where the density is high"),
        ),
    )
    color: FloatVectorProperty(
        name="Color",
        description="Color of the surface below moss and frost",
        default=(0.35, 0.3, 0.27, 1.0),
        size=4,
        min=0.0,
        max=1.0,
        subtype="COLOR",
    )
    threshold: FloatProperty(
        name="Threshold",
        description="Density at which moss and frost cover half of the surface, relative to the maximum",
        default=0.25,
        min=0.01,
        max=1.0,
        subtype="FACTOR",
    )

    @reporting_errors
    def execute(self, context):
        obj = context.object
        name = chosen_density(obj, self.density)
        density_modifier(obj, name)
        writable_mesh(obj)
        if self.kind == "HEAT":
            obj.active_material = heat_material(name)
        else:
            obj.active_material = growth_material(name, self.kind, tuple(self.color), threshold=self.threshold)
        return {"FINISHED"}


class CONVWASS_OT_rebake_density(OnDensity, bpy.types.Operator):
    """Interpolate an animated density again with its stored groups and settings; its keys are kept"""

    bl_idname = "convwass.rebake_density"
    bl_label = "Interpolate Again"

    density: density_property()
    only_if_changed: BoolProperty(
        name="Only if Changed", description="Do nothing if the groups and the mesh have not changed", default=False
    )

    def invoke(self, context, event):
        return self._bake(context, "INVOKE_DEFAULT")

    def execute(self, context):
        return self._bake(context, "EXEC_DEFAULT")

    def _bake(self, context: bpy.types.Context, how: str) -> set[str]:
        obj = context.object
        name = chosen_density(obj, self.density)
        try:
            stored = stored_density(obj, name)
            changed = changed_inputs(obj, stored)
            if self.only_if_changed and not changed:
                self.report({"INFO"}, rpt_("The groups and the mesh have not changed"))
                return {"CANCELLED"}
            _call(bpy.ops.convwass.interpolate_density, how, name, stored)
        except ConvwassError as error:
            return refuse(self, error)
        except RuntimeError as error:
            self.report({"ERROR"}, str(reason(error)))
            return {"CANCELLED"}
        if changed:
            self.report({"INFO"}, rpt_("Changed since it was made: {:s}").format(", ".join(changed)))
        return {"FINISHED"}


def _call(operator: Callable[..., set[str]], how: str, name: str, stored: StoredDensity) -> None:
    """Call Interpolate Density with the stored settings; raises InputError if they are damaged."""
    try:
        settings = stored.settings
        arguments = {
            **arguments_of(settings, DensitySettings),
            **arguments_of(settings, DensityRequest),
            "groups": "\n".join(stored.inputs),
            "frames": ", ".join(repr(float(frame)) for frame in settings["frames"]),
        }
        operator(how, density=name, set_keys=False, add_material=False, **arguments)
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(
            "The data stored with {name} is damaged ({reason}); interpolate it again.", name=name, reason=str(error)
        ) from error


classes = (
    CONVWASS_OT_bake_density,
    CONVWASS_OT_remove_density,
    CONVWASS_OT_show_density_material,
    CONVWASS_OT_rebake_density,
)
