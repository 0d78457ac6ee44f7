# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake and render a morph from the command line."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from contextlib import AbstractContextManager, nullcontext, suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import bpy

from .. import extension_id
from ..applications.flat.flat_settings import FlatSettings
from ..applications.morphs.computation import Computation
from ..applications.morphs.layouts import Blend
from ..applications.morphs.morph_settings import MorphSettings
from ..bridge.flat.flat_job import FlatJob
from ..bridge.flat.picture_job import PictureJob
from ..bridge.frame_range import play_whole
from ..bridge.morphs.job import MorphJob
from ..bridge.morphs.pictures.animation import render_animation
from ..bridge.morphs.pictures.contact_sheet import render_contact_sheet
from ..bridge.morphs.stored import stored_diagnostics
from ..bridge.studio.rendered_scene import move_result
from ..console import ProgressBar
from ..errors import InputError
from ..progress import Progress, watched
from .answer import Answer
from .morph_choices import Computing
from .reports import note


@dataclass(frozen=True)
class RenderSamples:
    """Light paths per pixel of the rendered picture and movie, before denoising."""

    picture: int
    movie: int


USUAL_SAMPLES = RenderSamples(12, 8)
"""For pictures to be kept."""

FEW_SAMPLES = RenderSamples(4, 2)
"""For a first look, in half the time."""

# Colors of shapes without materials.
_PALETTE = ((0.55, 0.09, 0.035, 1.0), (0.72, 0.30, 0.02, 1.0), (0.02, 0.13, 0.40, 1.0), (0.08, 0.24, 0.06, 1.0))


def baked(
    inputs: list[bpy.types.Object],
    blends: list[Blend],
    settings: MorphSettings,
    stored: dict[str, object],
    computing: Computing,
) -> tuple[bpy.types.Collection, list[dict[str, object]]]:
    """Bake a morph into the scene; return its collection and the records of its frames."""
    job = prepared_job(inputs, blends, settings, stored)
    try:
        run_job(job, computing, job.write)
    except BaseException:
        job.discard()
        raise
    collection = job.finish(hide_inputs=True)
    told = [each.text for each in stored_diagnostics(collection) if each.kind != "GOOD"]
    note(*dict.fromkeys([*map(str, job.notices), *told]))
    if job.span is not None:
        play_whole(bpy.context.scene, *job.span)
    return collection, job.records


def prepared_job(
    inputs: list[bpy.types.Object], blends: list[Blend], settings: MorphSettings, stored: dict[str, object]
) -> MorphJob | FlatJob | PictureJob:
    """Return the job of a bake; inputs without materials get a color."""
    for index, obj in enumerate(inputs):
        if not any(slot.material for slot in obj.material_slots):
            obj.color = _PALETTE[index % len(_PALETTE)]
    kind = FlatJob if isinstance(settings, FlatSettings) else MorphJob
    if stored.get("flat_output") == "PICTURE":
        kind = PictureJob
    return kind(inputs, blends, settings, stored, bpy.context.scene.frame_start)


def run_job(job: MorphJob | FlatJob | PictureJob, computing: Computing, take: Callable[[Progress[Any]], None]) -> None:
    """Run a job on the chosen threads or machines and pass its results on.

    Raises
    ------
    InputError
        A scheduler was requested from the extension installed in Blender.
    """
    cluster = _machines(computing.scheduler) if computing.scheduler else nullcontext()
    with cluster as executor, ProgressBar("Morphing") as bar:
        computation = Computation(computing.workers, executor, computing.cache, computing.wanted)
        if computing.between is None:
            work = job.steps(computation=computation)
        else:
            work = job.steps_between(computing.between.path, computing.between.numbers, computation)
        bar.result_of(watched(work, take))
    if computing.cache is not None:
        note(*computing.cache.notices)


def _machines(scheduler: str) -> AbstractContextManager[Executor]:
    """Connect to the machines of a cluster."""
    # Workers cannot import the add-on under the name that it has as an installed extension.
    if not extension_id().startswith("bl_ext."):
        with suppress(ModuleNotFoundError):  # not part of the installed extension
            from ..cluster import cluster_workers

            return cluster_workers(scheduler)
    raise InputError(
        "The extension installed in Blender does not use the network; run --scheduler from the project's folder with: "
        "python -m convwass_addon"
    )


def rendered(
    collection: bpy.types.Collection, target: Path, animated: bool, samples: RenderSamples = USUAL_SAMPLES
) -> list[Path]:
    """Render a picture of a morph and, if `animated`, a movie, next to the file `target`.

    Neither is there unless both are finished.
    """
    with TemporaryDirectory(prefix="convwass-") as folder:
        unmoved = Path(folder) / target.name
        with ProgressBar("Rendering the picture") as bar:
            sheet = render_contact_sheet(collection, unmoved.with_suffix(".png"), samples=samples.picture)
            pictures = [bar.result_of(sheet)]
        if animated:
            with ProgressBar("Rendering the movie") as bar:
                movie = render_animation(collection, unmoved.with_suffix(".mp4"), samples=samples.movie)
                pictures.append(bar.result_of(movie))
        targets = [target.with_suffix(picture.suffix) for picture in pictures]
        for picture, final in zip(pictures, targets, strict=True):
            move_result(picture, final)
    return targets


def report(morph: str, settings: MorphSettings, records: list[dict[str, object]], written: list[Path]) -> Answer:
    """Return the answer for a finished morph."""
    record = {"morph": morph, "settings": settings.as_dict(), "frames": records}
    return Answer.of_files(record, written)
