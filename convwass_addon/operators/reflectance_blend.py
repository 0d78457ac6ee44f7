# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blend materials in the background."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import StringProperty

from ..applications.reflectance.reflectance_settings import ReflectanceSettings
from ..applications.reflectance.weight_sheets import spread_out
from ..bridge.files.output_paths import absolute_path, checked_target
from ..bridge.handles import Handle
from ..bridge.reflectance.glossy_materials import GlossyMaterial, read_glossy
from ..bridge.reflectance.material_pad import material_pad
from ..errors import InputError
from ..progress import UNINTERRUPTED, Control, Progress, Work
from ..properties.light import ReflectanceProperties, sun_of
from ..sentence import Sentence
from .background import BackgroundOperator, is_idle
from .chosen_inputs import split_names
from .reflectance_weights import BlendPlan, blend_plan
from .reporting import tell

if TYPE_CHECKING:
    from ..applications.reflectance.lobe_frames import LobeFrame
    from ..bridge.reflectance.lobe_materials import PrincipledFit


class ReflectanceJob:
    """Blends materials. All methods except :meth:`steps` must be called on the main thread.

    Parameters
    ----------
    materials : sequence of GlossyMaterial
        Two to four.
    plan : BlendPlan
        Weights of the blends.
    settings : ReflectanceSettings
        Settings of the transport.
    sun : bpy.types.Object or None
        The sun that tabulated highlights follow.
    """

    def __init__(
        self,
        materials: Sequence[GlossyMaterial],
        plan: BlendPlan,
        settings: ReflectanceSettings,
        sun: bpy.types.Object | None,
    ) -> None:
        self.materials = tuple(materials)
        self.plan, self._settings = plan, settings
        self._sun = None if sun is None else Handle.of("objects", sun)
        self.found: list[LobeFrame] = []

    def steps(self, control: Control = UNINTERRUPTED) -> Work[None]:
        """Compute all blends."""
        from ..applications.reflectance.lobe_frames import lobe_frames

        return lobe_frames([own.lobe for own in self.materials], self.plan.weights, self._settings, control)

    def write(self, report: Progress[LobeFrame]) -> None:
        """Collect a finished blend; the file is only changed at the end."""
        if report.payload is not None:
            self.found.append(report.payload)

    def discard(self) -> None:
        """Discard the result."""
        self.found = []

    @property
    def sun(self) -> bpy.types.Object | None:
        """The sun that tabulated highlights follow; None if it was deleted."""
        return None if self._sun is None else self._sun.find()

    @property
    def has_grain(self) -> bool:
        """Whether a material is anisotropic, so that a lookup image cannot represent it."""
        return not all(own.lobe.is_isotropic for own in self.materials)

    def fits(self) -> list[PrincipledFit]:
        """Return the settings of the fitted Principled BSDF for each blend."""
        from ..bridge.reflectance.lobe_materials import PrincipledFit, mixed

        return [
            PrincipledFit(
                frame.fit.material,
                mixed([own.base_color for own in self.materials], frame.weights),
                float(frame.weights @ [own.metallic for own in self.materials]),
            )
            for frame in self.shown
        ]

    @property
    def shown(self) -> list[LobeFrame]:
        """The blends in display order."""
        return self.found if self.plan.sheet is None else spread_out(self.plan.sheet, self.found)

    def diffuse(self) -> list[tuple[float, float, float]]:
        """Return the diffuse color of each blend."""
        from ..bridge.reflectance.lobe_materials import mixed

        return [mixed([own.diffuse for own in self.materials], frame.weights) for frame in self.shown]


class CONVWASS_OT_blend_materials(ReflectanceProperties, BackgroundOperator, bpy.types.Operator):
    """Blend two to four materials: highlights move and change their shape, instead of one fading out while another fades in"""  # noqa: E501

    bl_idname = "convwass.blend_materials"
    bl_label = "Blend Materials"
    bl_options = {"REGISTER", "UNDO"}
    _title = Sentence("Blending materials")

    materials: StringProperty(
        name="Materials",
        description="Names of materials, one per line or separated by commas; empty for the materials chosen in the "
        "panel",
        options={"SKIP_SAVE"},
    )
    weights: StringProperty(
        name="Weights",
        description="Numbers separated by commas, one per material; for a path, several rows separated by semicolons. "
        "Empty for the weights in the panel",
        options={"SKIP_SAVE"},
    )

    @classmethod
    def poll(cls, context):
        return is_idle(cls, context)

    def _begin(self, context):
        chosen = self._chosen(context)
        read = [read_glossy(material) for material in chosen]
        plan = blend_plan(context.scene, self, self.weights, [material.name for material in chosen])
        job = ReflectanceJob(read, plan, self.reflectance_settings(), sun_of(context))
        if job.has_grain and self.output == "LOBES":
            raise InputError(
                "Anisotropic highlights cannot be tabulated by two angles; choose Fitted, or set the anisotropy to 0."
            )
        if self.table:
            self._checked_table(job)
        return job

    def _chosen(self, context: bpy.types.Context) -> list[bpy.types.Material]:
        chosen = [material for material, _ in context.scene.convwass_reflectance.chosen_materials]
        if self.materials.strip():
            chosen = [_named(name) for name in split_names(self.materials, bpy.data.materials)]
        if not 2 <= len(chosen) <= 4:
            raise InputError("Choose two to four materials, not {count}.", count=len(chosen))
        return chosen

    def _checked_table(self, job: ReflectanceJob) -> Path:
        from ..bridge.reflectance.lobe_files import is_whole

        target = checked_target(absolute_path(self.table))
        if target.suffix.lower() not in (".npz", ".exr"):
            raise InputError("{name} does not end in .npz or .exr.", name=target.name)
        if is_whole(target) and self.blend != "WEIGHTS":
            raise InputError(".npz and .lobes.exr files hold one blend; choose By Weights, or a different .exr file.")
        if not is_whole(target) and job.has_grain:
            raise InputError("Anisotropic materials need all directions; choose .npz or .lobes.exr.")
        return target

    def _finish(self, context, job):
        if self.table:
            self._write_table(job)
        name = "{} {}".format(rpt_("Blend"), "-".join(own.name for own in job.materials))
        if self.blend == "WEIGHTS":
            name = "{} {}".format(name, ":".join(f"{100 * weight:.0f}" for weight in job.found[0].weights))
        if self.blend == "PAD":
            name = "{} {}".format(name, rpt_("on a pad"))
        made = self._made(context, job, name)
        text = rpt_("Made {:s}; the fitted one differs by at most {:.0f} % of the light")
        worst = 100 * max(frame.fit.total_variation for frame in job.found)
        if self.output == "LOBES":
            text = rpt_("Made {:s}")
        tell(self, text.format(", ".join(own.name for own in made), worst), self._remarks(job), _warnings(job))
        return {"FINISHED"}

    def _made(self, context: bpy.types.Context, job: ReflectanceJob, name: str) -> list[bpy.types.Material]:
        """Create the materials and their drivers."""
        from ..bridge.reflectance.lobe_materials import fitted_material, lobe_material
        from ..bridge.reflectance.pad_materials import pad_fitted_material, pad_lobe_material

        with_lobes = self.output != "FITTED" and not job.has_grain
        images = [frame.image for frame in job.shown] if with_lobes else []
        fitted = "{} {}".format(name, rpt_("fitted"))
        if job.plan.sheet is not None:
            names = [own.name for own in job.materials]
            moved_by = material_pad(self._own_scene(context), name, names, job.plan.sheet.side)
            of_lobes, of_fits = pad_lobe_material, pad_fitted_material
        else:
            moved_by = self.frame_span() if self.blend != "WEIGHTS" else None
            of_lobes, of_fits = lobe_material, fitted_material
        made = [of_lobes(name, images, job.diffuse(), job.sun, moved_by)] if with_lobes else []
        if self.output != "LOBES":
            made.append(of_fits(fitted, job.fits(), moved_by))
        return made

    def _write_table(self, job: ReflectanceJob) -> None:
        from ..bridge.reflectance.lobe_files import is_whole, write_whole_table
        from ..bridge.reflectance.lobe_images import write_lobe_exr

        target = self._checked_table(job)
        if is_whole(target):
            write_whole_table(target, job.found[0].table)
        else:
            write_lobe_exr(target, [frame.image for frame in job.shown])

    def _remarks(self, job: ReflectanceJob) -> list[Sentence]:
        remarks = [notice for own in job.materials for notice in own.notices]
        if self.output != "FITTED" and not job.has_grain and job.sun is None:
            remarks.append(Sentence("The scene has no sun; set the direction of the light in the node group."))
        return remarks


def _warnings(job: ReflectanceJob) -> list[Sentence]:
    seen = {str(notice): notice for frame in job.found for notice in frame.notices}
    return list(seen.values())


def _named(name: str) -> bpy.types.Material:
    material = bpy.data.materials.get(name)
    if material is None:
        raise InputError("There is no material named {name}.", name=name)
    return material


classes = (CONVWASS_OT_blend_materials,)
