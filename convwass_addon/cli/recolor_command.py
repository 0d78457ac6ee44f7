# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The command ``recolor``."""

from __future__ import annotations

import os
from argparse import Namespace
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray

from ..applications.palettes.lookup_table import LookupTable, lookup_table, read_cube, write_cube
from ..applications.palettes.palette_settings import RecolorSettings, TableSettings
from ..applications.palettes.palette_statistics import pooled_palette
from ..applications.palettes.pixel_blocks import recolored_blocks
from ..applications.palettes.recolor_job import Picture, solved_map
from ..applications.palettes.recoloring import Recoloring
from ..applications.whole_paths import path_with_suffix, whole_path
from ..applications.workers import thread_count
from ..bridge.files.numbered_files import numbered_paths
from ..bridge.files.output_paths import checked_target
from ..bridge.palettes.image_files import require_depth, save_pixels
from ..console import ProgressBar
from ..drafts import DraftFiles
from ..errors import InputError
from ..progress import drained
from .answer import Answer
from .from_schema import given_options, given_settings
from .overwriting import refuse_overwriting
from .recolor_frames import Frames, opened_frames, read_file
from .reports import note_leftovers


def run_recolor(options: Namespace) -> Answer:
    """Recolor images, or write a lookup table.

    Raises
    ------
    InputError, ResourceError
        The images or options cannot be used.
    """
    _check_options(options)
    settings = RecolorSettings(**given_settings(options, RecolorSettings))
    table = TableSettings(**given_settings(options, TableSettings))
    cube = None if options.cube is None else checked_target(path_with_suffix(options.cube, ".cube"))
    with opened_frames(options.images, options.mask) as frames:
        targets = _targets(options, frames.names)
        refuse_overwriting(_sources(options), [*targets, cube])
        change = _solved(options, frames, settings) if options.lut is None else _read_table(options.lut, settings)
        record: dict[str, object] = {"images": [str(path) for path in options.images]}
        if isinstance(change, Recoloring):
            record |= {"palettes": [str(path) for path in options.palette], **change.record}
        drafts = DraftFiles()
        try:
            if cube is not None:
                write_cube(lookup_table(change, table.cube_size), drafts.draft_of(cube), options.palette[0].stem)
            _write_recolored(options, frames, change, targets, drafts)
            written = drafts.keep()
        finally:
            drafts.discard()
    if options.steps is not None:
        note_leftovers(written)
    return Answer.of_files(record, written)


def _check_options(options: Namespace) -> None:
    thread_count(options.workers)
    if not options.palette and options.lut is None:
        raise InputError("Name a palette with --palette, or a lookup table with --lut.")
    if options.palette and options.lut is not None:
        raise InputError("--palette and --lut cannot be combined; choose one.")
    if options.out is None and options.cube is None:
        raise InputError("Nothing would be written; name an image with --out, or a lookup table with --cube.")
    if options.lut is not None:
        _refuse_options_of_maps(options)
    if options.cube is None and given_options(options, TableSettings):
        raise InputError("--cube-size is the size of a lookup table; name one with --cube.")
    if options.weights is not None and len(options.weights) != len(options.palette):
        raise InputError("Give one weight for each of the {count} palettes.", count=len(options.palette))
    if options.palette_mask is not None and len(options.palette) != 1:
        raise InputError("--palette-mask requires exactly one palette.")
    is_image = len(options.images) == 1 and options.images[0].suffix.lower() not in bpy.path.extensions_movie
    if options.steps is not None and not (options.steps >= 2 and is_image):
        raise InputError("--steps must be 2 or more and requires exactly one image.")


def _refuse_options_of_maps(options: Namespace) -> None:
    """Raise InputError if there are options that only apply to maps between palettes, not to existing tables."""
    if options.weights is not None:
        raise InputError("--weights weights palettes, and --lut has none; leave out --weights.")
    given = [f"--{name}" for name in ("cube", "steps") if getattr(options, name) is not None]
    given += given_options(options, TableSettings)
    given += [option for option in given_options(options, RecolorSettings) if option != "--strength"]
    if given:
        raise InputError("--lut applies an existing table; leave out {options}.", options=", ".join(given))


def _targets(options: Namespace, names: Sequence[str]) -> list[Path]:
    """Return the output files for images with these names; raises InputError if they cannot be written."""
    if options.out is None:
        return []
    count = options.steps or len(names)
    if count == 1 and not os.path.isdir(options.out):
        target = checked_target(options.out)
        require_depth(target, options.depth)
        return [target]
    folder = whole_path(options.out)
    if not folder.is_dir():
        checked_target(folder / "x" if folder.exists() else folder)
    if options.steps is not None:
        stem, suffix = options.images[0].stem, options.images[0].suffix
        targets = numbered_paths(folder, f"{stem}.", suffix, range(count))
    else:
        targets = [folder / name for name in names]
    if len(set(targets)) < len(targets):
        raise InputError("The results would overwrite each other; give the images different names.")
    for target in targets:
        require_depth(checked_target(target) if folder.is_dir() else target, options.depth)
    return targets


def _sources(options: Namespace) -> list[Path | None]:
    """Return all files that are read."""
    return [*options.images, *options.palette, options.mask, options.palette_mask, options.lut]


def _read_table(path: Path, settings: RecolorSettings) -> LookupTable:
    """Read the table of ``--lut``, to be applied at the strength of the settings."""
    return replace(read_cube(path), strength=settings.strength)


def _solved(options: Namespace, frames: Frames, settings: RecolorSettings) -> Recoloring:
    with ProgressBar("Matching palettes") as bar:
        bar.show(0.0, "measuring")
        measured = []
        for place in range(len(frames.names)):
            with frames.read(place) as (picture, _image):
                measured.append(picture.palette() if len(frames.names) == 1 else picture.palette_if_any())
        own = pooled_palette(measured)
        bar.show(0.5, "solving")
        wanted = []
        for path in options.palette:
            with read_file(path, options.palette_mask) as (picture, _image):
                wanted.append(picture.palette())
        change = solved_map(own, wanted, options.weights, settings)
        bar.show(1.0, "done")
    return change


def _write_recolored(
    options: Namespace,
    frames: Frames,
    change: Recoloring | LookupTable,
    targets: Sequence[Path],
    drafts: DraftFiles,
) -> None:
    """Write all images as drafts."""
    if not targets:
        return
    with ProgressBar("Recoloring") as bar:
        if options.steps is not None:
            shares = np.linspace(0.0, change.settings.strength, options.steps)
            jobs = [(0, replace(change, settings=replace(change.settings, strength=float(share)))) for share in shares]
        else:
            jobs = [(place, change) for place in range(len(targets))]
        for done, ((place, own), target) in enumerate(zip(jobs, targets, strict=True), 1):
            with frames.read(place) as (picture, image):
                save_pixels(_changed(picture, own, options.workers), image, drafts.draft_of(target), options.depth)
            bar.show(done / len(jobs), target.name)


def _changed(picture: Picture, change: Recoloring | LookupTable, workers: int | None) -> NDArray[np.float32]:
    out = np.empty_like(picture.pixels)
    drained(recolored_blocks(picture.pixels, picture.pixel_format, change, picture.mask, out, workers=workers))
    return out
