# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Make a material between others, beside the user's work."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import StringProperty
from numpy.typing import NDArray

from ..applications.reflectance.reflectance_settings import ReflectanceSettings
from ..applications.reflectance.table_files import write_table
from ..bridge.files import checked_target
from ..bridge.handles import Handle
from ..bridge.reflectance.glossy_materials import GlossyMaterial, read_glossy
from ..bridge.reflectance.lobe_frames import LobeFrame, LobeFrameStep, lobe_frames, path_weights
from ..bridge.reflectance.lobe_images import write_lobe_exr
from ..bridge.reflectance.lobe_materials import FittedLook, fitted_material, lobe_material, mixed
from ..errors import InputError
from ..light_properties import ReflectanceProperties, sun_of
from ..sentence import Sentence
from .background import BackgroundOperator, is_idle
from .chosen_inputs import split_names
from .density_targets import tell


class ReflectanceJob:
    """One blend of materials. Everything but :meth:`steps` belongs on the main thread.

    Parameters
    ----------
    materials : sequence of GlossyMaterial
        Two to four.
    weights : (n, k) array
        One row for every blend.
    settings : ReflectanceSettings
        How.
    sun : bpy.types.Object or None
        What tabulated highlights follow.
    """

    def __init__(
        self,
        materials: Sequence[GlossyMaterial],
        weights: NDArray[np.float64],
        settings: ReflectanceSettings,
        sun: bpy.types.Object | None,
    ) -> None:
        self.materials = tuple(materials)
        self._weights, self._settings = weights, settings
        self._sun = None if sun is None else Handle.of("objects", sun)
        self.found: list[LobeFrame] = []

    def steps(self, check: Callable[[], None] | None = None) -> Iterator[LobeFrameStep]:
        """Yield the steps of the work; whoever runs them checks between them."""
        for step in lobe_frames([own.lobe for own in self.materials], self._weights, self._settings):
            if check is not None:
                check()
            yield step

    def write(self, step: LobeFrameStep) -> None:
        """Take what a step has brought; the file stays as it is until the end."""
        if step.frame is not None:
            self.found.append(step.frame)

    def discard(self) -> None:
        """Forget it."""
        self.found = []

    @property
    def sun(self) -> bpy.types.Object | None:
        """What tabulated highlights follow; None where it is gone."""
        return None if self._sun is None else self._sun.find()

    @property
    def has_grain(self) -> bool:
        """Whether no picture could show the lobes."""
        return not all(own.lobe.is_isotropic for own in self.materials)

    def looks(self) -> list[FittedLook]:
        """Return what the fitted material is set to, blend by blend."""
        return [
            FittedLook(
                frame.fit.material,
                mixed([own.base_color for own in self.materials], frame.weights),
                float(frame.weights @ [own.metallic for own in self.materials]),
            )
            for frame in self.found
        ]

    def diffuse(self) -> list[tuple[float, float, float]]:
        """Return matte colors, blend by blend."""
        return [mixed([own.diffuse for own in self.materials], frame.weights) for frame in self.found]


class CONVWASS_OT_interpolate_reflectance(ReflectanceProperties, BackgroundOperator, bpy.types.Operator):
    """Make a material between two to four others, whose highlights move and change their shape instead of fading out here and in there"""  # noqa: E501

    bl_idname = "convwass.interpolate_reflectance"
    bl_label = "Blend Materials"
    bl_options = {"REGISTER", "UNDO"}

    materials: StringProperty(
        name="Materials",
        description="Names of materials, one per line or with commas between them; empty for those that are chosen in "
        "the panel",
        options={"SKIP_SAVE"},
    )
    weights: StringProperty(
        name="Weights",
        description="Numbers with commas between them, one per material; empty for those in the panel",
        options={"SKIP_SAVE"},
    )
    table: StringProperty(
        name="Table",
        description="File that the table goes to as well: .npz holds all directions of one blend, .exr what the node "
        "group looks up; empty for none",
        subtype="FILE_PATH",
        options={"SKIP_SAVE"},
    )

    _job: ReflectanceJob

    @classmethod
    def poll(cls, context):
        return is_idle(cls, context)

    def _begin(self, context):
        chosen, weights = self._chosen(context)
        read = [read_glossy(material) for material in chosen]
        job = ReflectanceJob(
            read,
            path_weights(self.blends, len(read)) if self.blend == "PATH" else np.array([weights]),
            self.reflectance_settings(),
            sun_of(context),
        )
        if job.has_grain and self.output == "LOBES":
            raise InputError(
                "Highlights along a grain cannot be looked up by two angles; choose Fitted, or set the anisotropy to 0."
            )
        if self.blend == "PATH" and self.frame_end <= self.frame_start:
            raise InputError("The last frame must come after the first one.")
        if self.table:
            self._checked_table(job)
        return job

    def _chosen(self, context: bpy.types.Context) -> tuple[list[bpy.types.Material], list[float]]:
        pairs = context.scene.convwass_reflectance.chosen_materials
        if self.materials.strip():
            pairs = [(_named(name), 1.0) for name in split_names(self.materials)]
        if not 2 <= len(pairs) <= 4:
            raise InputError("Choose two to four materials, not {count}.", count=len(pairs))
        weights = [weight for _, weight in pairs]
        if self.weights.strip():
            try:
                weights = [float(word) for word in self.weights.split(",")]
            except ValueError as error:
                raise InputError(
                    "Weights are numbers with commas between them, not {text!r}.", text=self.weights
                ) from error
        return [material for material, _ in pairs], weights

    def _checked_table(self, job: ReflectanceJob) -> Path:
        target = checked_target(Path(bpy.path.abspath(self.table)))
        kind = target.suffix.lower()
        if kind not in (".npz", ".exr"):
            raise InputError("{name} ends neither in .npz nor in .exr.", name=target.name)
        if kind == ".npz" and self.blend == "PATH":
            raise InputError("A file .npz holds one blend; choose By Weights, or a file .exr.")
        if kind == ".exr" and job.has_grain:
            raise InputError("Materials with a grain fill no .exr; choose .npz.")
        return target

    def _steps(self):
        return self._job.steps

    def _title(self):
        return rpt_("Blending materials")

    def _finish(self, context, job):
        if self.table:
            self._write_table(job)
        name = "{} {}".format(rpt_("Blend"), "-".join(own.name for own in job.materials))
        if self.blend == "WEIGHTS":
            name = "{} {}".format(name, ":".join(f"{100 * weight:.0f}" for weight in job.found[0].weights))
        frames = self.frame_span() if self.blend == "PATH" else None
        made = []
        if self.output != "FITTED" and not job.has_grain:
            images = [frame.image for frame in job.found]
            made.append(lobe_material(name, images, job.diffuse(), job.sun, frames))
        if self.output != "LOBES":
            made.append(fitted_material("{} {}".format(name, rpt_("fitted")), job.looks(), frames))
        text = rpt_("Made {:s}; the fitted one differs by {:.0f} % of the light at most")
        worst = 100 * max(frame.fit.total_variation for frame in job.found)
        if self.output == "LOBES":
            text = rpt_("Made {:s}")
        tell(self, text.format(", ".join(own.name for own in made), worst), self._remarks(job), _warnings(job))
        return {"FINISHED"}

    def _write_table(self, job: ReflectanceJob) -> None:
        target = self._checked_table(job)
        if target.suffix.lower() == ".npz":
            write_table(target, job.found[0].table)
        else:
            write_lobe_exr(target, [frame.image for frame in job.found])

    def _remarks(self, job: ReflectanceJob) -> list[Sentence]:
        remarks = [notice for own in job.materials for notice in own.notices]
        if self.output != "FITTED" and not job.has_grain and job.sun is None:
            remarks.append(Sentence("There is no sun in the scene; set the direction of the light in the node group."))
        return remarks


def _warnings(job: ReflectanceJob) -> list[Sentence]:
    seen = {str(notice): notice for frame in job.found for notice in frame.notices}
    return list(seen.values())


def _named(name: str) -> bpy.types.Material:
    material = bpy.data.materials.get(name)
    if material is None:
        raise InputError("There is no material {name}.", name=name)
    return material


classes = (CONVWASS_OT_interpolate_reflectance,)
