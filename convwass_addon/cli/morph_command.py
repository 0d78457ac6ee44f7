# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The command ``morph``."""

from __future__ import annotations

import sys
from argparse import Namespace
from dataclasses import replace

import bpy

from ..applications.morphs.bake_plan import MorphPreview
from ..applications.morphs.between_frames import places_at
from ..applications.morphs.layouts import Blend
from ..applications.morphs.morph_problem import MorphFrame
from ..applications.morphs.morph_settings import MorphSettings
from ..applications.morphs.shape_check import check_shape
from ..applications.whole_paths import path_with_suffix
from ..bridge.files.blend_files import open_empty
from ..bridge.files.imports import live_shape
from ..bridge.files.output_paths import checked_target
from ..bridge.flat.choosing import asks_for_flat, refuse_following
from ..bridge.flat.flat_imports import imported_shape
from ..bridge.flat.picture_bake import pictures_of
from ..bridge.morphs.disk.exports import export_frames
from ..bridge.morphs.inputs.followed_inputs import FOLLOW
from ..bridge.morphs.inputs.guides_of_files import guides_asked_for
from ..bridge.morphs.outputs import SHAPE_KEYS, save_as
from ..bridge.objects import MESHED, triangle_mesh
from ..progress import Progress
from .answer import Answer
from .from_schema import given_settings
from .morph_baking import baked, prepared_job, rendered, report, run_job
from .morph_choices import (
    Computing,
    between_of,
    computing_of,
    export_format,
    flat_settings_of,
    refuse_idle_options,
    refuse_unsuitable_output,
    request_of,
)
from .morph_files import files_read, files_written
from .overwriting import refuse_overwriting
from .reports import note, note_leftovers
from .shape_key_command import with_shape_keys


def run_morph(options: Namespace) -> Answer:
    """Bake a morph, or only some of its frames into a cache.

    Raises
    ------
    InputError, ResourceError
        The shapes or options cannot be used.
    """
    refuse_idle_options(options)
    settings = MorphSettings(**given_settings(options, MorphSettings))
    target = path_with_suffix(options.out, ".blend")
    if options.frames_range is None:
        target = checked_target(target)
    request = request_of(options, target)
    blends = request.blends(len(options.shapes))
    between = None
    if options.at is not None:
        between = between_of(options, request, blends)
        blends = [place.blend for place in places_at(between.path, between.numbers)]
    # Check everything before the work begins.
    if options.frames_range is None:
        refuse_overwriting(files_read(options), files_written(options, target, len(blends)))
    refuse_unsuitable_output(options, request, blends)
    has_frames = options.output != SHAPE_KEYS
    exported = export_format(options.export) if options.export and has_frames else None
    computing = computing_of(options, blends, between)
    open_empty()
    inputs = []
    follows = request.follow == FOLLOW
    for text in options.shapes:
        inputs += live_shape(text) if follows else imported_shape(text)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    if not has_frames:
        return with_shape_keys(inputs, options, request, settings, target)
    if not asks_for_flat(inputs, depsgraph, settings.thickness):
        guides = guides_asked_for(options.guides, options.shapes, inputs, depsgraph)
        request = replace(request, guides=[guide.as_dict() for guide in guides])
        if guides and not settings.heeds_guides:
            note("--guides has no effect: it needs --motion automatic or guided, and a --coherence above 0")
        if not settings.thickness:
            _note_holes(inputs, depsgraph)
    else:
        settings = flat_settings_of(options)
        refuse_following(follows)
        if options.guides:
            note("flat shapes do not support guides; --guides is ignored")
    stored = request.as_dict()
    if computing.wanted is not None:
        return _cached(inputs, blends, settings, stored, computing)
    collection, records = baked(inputs, blends, settings, stored, computing)
    besides = rendered(collection, target, animated=blends[0].frame is not None) if options.render else []
    if exported:
        besides += export_frames(collection, options.export, exported)
    written = save_as(collection, options.output, target) + pictures_of(collection) + besides
    note_leftovers(written)
    return report(collection.name, settings, records, written)


def _note_holes(inputs: list[bpy.types.Object], depsgraph: bpy.types.Depsgraph) -> None:
    """Tell which shapes are open, as the list of inputs does in the panel."""
    for obj in inputs:
        if obj.type in MESHED:
            count = check_shape(triangle_mesh(obj, depsgraph, MESHED)).open_edges
            if count:
                note(f"{obj.name} has holes with {count} open edges; the volume that they nearly enclose is filled")


def _cached(
    inputs: list[bpy.types.Object],
    blends: list[Blend],
    settings: MorphSettings,
    stored: dict[str, object],
    computing: Computing,
) -> Answer:
    """Compute frames into the cache without changing the scene."""
    job = prepared_job(inputs, blends, settings, stored)
    frames, records = [], []

    def take(report: Progress[MorphFrame | MorphPreview]) -> None:
        if isinstance(report.payload, MorphFrame):
            frames.append(report.payload.blend.frame)
            records.append(report.payload.record)

    try:
        run_job(job, computing, take)
    finally:
        job.discard()
    folder = computing.cache.folder
    print(
        f"convwass: frames {frames[0]}-{frames[-1]} of {blends[-1].frame} are in {folder}; the same command without "
        "--frames-range writes the .blend once all frames are there",
        file=sys.stderr,
    )
    record = {"settings": settings.as_dict(), "range": [frames[0], frames[-1]], "frames": records}
    return Answer.of_files(record, [folder])
