# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Implementation of ``morph --output shape-keys``."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import bpy

from ..applications.morphs.computation import Computation
from ..applications.morphs.morph_settings import MorphSettings
from ..applications.one_mesh.texture_settings import TextureSettings
from ..bridge.files.output_paths import creatable_folder, save_blend
from ..bridge.frame_range import play_whole
from ..bridge.morphs.inputs.guides_of_files import guides_asked_for
from ..bridge.morphs.morph_request import MorphRequest
from ..bridge.one_mesh.key_files import checked_key_target, export_shape_keys, left_out_notices
from ..bridge.one_mesh.key_notices import key_summary, poor_notices, swap_summary
from ..bridge.one_mesh.shape_key_job import ShapeKeyJob, refuse_one_mesh
from ..bridge.one_mesh.swap_job import SwapJob
from ..bridge.one_mesh.texture_job import BakedTextures, TextureJob
from ..console import ProgressBar
from ..errors import InputError
from ..sentence import Sentence
from .answer import Answer
from .from_schema import given_settings
from .reports import note

# Options that only apply to one mesh.
_OF_ONE_MESH = ("export", "textures")


def with_shape_keys(
    inputs: list[bpy.types.Object], options: Namespace, request: MorphRequest, settings: MorphSettings, target: Path
) -> Answer:
    """Add shape keys to the first mesh that lead to the other shapes, and save it.

    Raises
    ------
    InputError
        The shapes are not meshes or too different, or options exclude each other.
    """
    refuse_one_mesh(inputs)
    exported = checked_key_target(options.export) if options.export else None
    textures = _texture_settings(options, target)
    guides = guides_asked_for(options.guides, options.shapes, inputs, bpy.context.evaluated_depsgraph_get())
    request = replace(request, guides=[guide.as_dict() for guide in guides])
    if request.two_meshes:
        return _with_two_meshes(inputs, options, request, settings, target)
    job = ShapeKeyJob(inputs, request, settings, bpy.context.scene.frame_start)
    (obj,) = _finished(job, options.workers)
    summary, notices = key_summary(obj.name, job.paths), [*job.notices, *poor_notices(job.paths)]
    record = {"object": obj.name, "coherence": settings.coherence, "shapes": [path.record() for path in job.paths]}
    besides = []
    if options.textures:
        baked = _baked_textures(obj, textures)
        record["textures"] = [image.name for image in baked.images]
        besides += baked.files
        notices += baked.notices
    if exported:
        besides += export_shape_keys(obj, exported)
        notices += left_out_notices(obj, exported)
    return _answer(record, summary, notices, [save_blend(target), *besides])


def _answer(
    record: dict[str, object], summary: Sentence, notices: Sequence[Sentence], written: Sequence[Path]
) -> Answer:
    """Print how well the meshes arrive and all notices, and return the answer with them."""
    note(summary, *notices)
    return Answer.of_files({**record, "notices": [str(notice) for notice in notices]}, written)


def _texture_settings(options: Namespace, target: Path) -> TextureSettings:
    """Return the settings of the textures, with the whole path of their folder, which is checked before the work."""
    settings = TextureSettings(**given_settings(options, TextureSettings))
    if not settings.texture_folder:
        return settings
    # The .blend file that // refers to is not open, but written at the end.
    folder = creatable_folder(bpy.path.abspath(settings.texture_folder, start=str(target.parent)))
    return replace(settings, texture_folder=str(folder))


def _with_two_meshes(
    inputs: list[bpy.types.Object], options: Namespace, request: MorphRequest, settings: MorphSettings, target: Path
) -> Answer:
    """Add shape keys to the meshes of two shapes, one of which replaces the other, and save them."""
    given = [name for name in _OF_ONE_MESH if getattr(options, name)]
    if given:
        raise InputError("--two-meshes makes two objects; leave out --{option}.", option=given[0])
    job = SwapJob(inputs, request, settings, bpy.context.scene.frame_start)
    made = _finished(job, options.workers)
    summary = swap_summary(made[0].name, made[1].name, job.found)
    record = {"objects": [obj.name for obj in made], "coherence": settings.coherence, **job.found.record()}
    return _answer(record, summary, [*job.notices, *poor_notices(job.paths)], [save_blend(target)])


def _finished(job: ShapeKeyJob | SwapJob, workers: int | None) -> list[bpy.types.Object]:
    """Run a job with a progress bar, and return what it made."""
    try:
        with ProgressBar("Making shape keys") as bar:
            bar.result_of(job.steps(computation=Computation(workers=workers)))
        made = job.finish(hide_inputs=True)
    except BaseException:
        job.discard()
        raise
    play_whole(bpy.context.scene, *job.span)
    return made


def _baked_textures(obj: bpy.types.Object, settings: TextureSettings) -> BakedTextures:
    """Bake images of the looks of the shapes, at the start of the animation."""
    job = TextureJob(obj, settings)
    try:
        with ProgressBar("Baking textures") as bar:
            bar.result_of(job.steps())
        return job.finish()
    finally:
        job.discard()
