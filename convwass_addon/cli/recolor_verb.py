# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The verb ``recolor``."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray

from ..applications.palettes.lookup_table import LookupTable, lookup_table, read_cube, write_cube
from ..applications.palettes.palette_settings import RecolorSettings
from ..applications.palettes.palette_statistics import Palette, pooled_palette
from ..applications.palettes.pixel_blocks import recolored_blocks
from ..applications.palettes.recolor_job import Picture
from ..applications.palettes.recoloring import Recoloring, recoloring
from ..bridge.files import checked_target
from ..bridge.palettes.image_files import opened_image, require_format, save_pixels
from ..bridge.palettes.image_pixels import read_picture
from ..console import ProgressBar
from ..errors import InputError
from .answer import Answer


def run_recolor(options: Namespace) -> Answer:
    """Do what the command line asks for.

    Raises
    ------
    InputError, ResourceError
        Images or options that cannot work.
    """
    _check_options(options)
    settings = RecolorSettings(
        strength=options.strength,
        lightness="keep" if options.keep_lightness else "transport",
        smoothing=options.smoothing,
        steepest=options.slope_limit,
        gamut=options.gamut,
        edge_radius=options.edge_radius,
    )
    cube = None if options.cube is None else checked_target(options.cube.with_suffix(".cube"))
    targets = _targets(options)
    change = read_cube(options.lut) if options.lut is not None else _solved(options, settings)
    record: dict[str, object] = {"images": [str(path) for path in options.images]}
    if isinstance(change, Recoloring):
        record |= {"palettes": [str(path) for path in options.palette], **change.record}
    written = []
    if cube is not None:
        write_cube(lookup_table(change, options.cube_size), cube, options.palette[0].stem)
        written.append(cube)
    written += _recolored(options, change, targets)
    return Answer.of_files(record, written)


def _check_options(options: Namespace) -> None:
    if bool(options.palette) == (options.lut is not None):
        raise InputError("Name a palette with --palette, or a table with --lut.")
    if options.out is None and options.cube is None:
        raise InputError("Nothing would be written; name an image with --out, or a table with --cube.")
    if options.lut is not None and (options.cube is not None or options.steps is not None):
        raise InputError("--lut applies a table as it is; it goes neither with --cube nor with --steps.")
    if options.weights is not None and len(options.weights) != len(options.palette):
        raise InputError("There must be one weight for each of the {count} palettes.", count=len(options.palette))
    if options.palette_mask is not None and len(options.palette) != 1:
        raise InputError("--palette-mask goes with one palette.")
    if options.steps is not None and not (options.steps >= 2 and len(options.images) == 1):
        raise InputError("--steps must be 2 or more, and goes with one image.")


def _targets(options: Namespace) -> list[Path]:
    """Return where the images go; raises InputError where they cannot."""
    if options.out is None:
        return []
    count = options.steps or len(options.images)
    if count == 1 and not options.out.is_dir():
        target = checked_target(options.out)
        require_format(target)
        return [target]
    folder = options.out.expanduser().absolute()
    if not folder.is_dir():
        checked_target(folder / "x" if folder.exists() else folder)
        folder.mkdir()
    if options.steps is not None:
        stem, suffix = options.images[0].stem, options.images[0].suffix
        targets = [folder / f"{stem}.{step:04d}{suffix}" for step in range(count)]
    else:
        targets = [folder / path.name for path in options.images]
    sources = {path.expanduser().absolute() for path in options.images}
    if len(set(targets)) < len(targets) or sources & set(targets):
        raise InputError("The results would replace each other, or the images; choose another folder with --out.")
    for target in targets:
        require_format(checked_target(target))
    return targets


def _solved(options: Namespace, settings: RecolorSettings) -> Recoloring:
    with ProgressBar("Matching palettes") as bar:
        bar.show(0.0, "measuring")
        own = pooled_palette([_palette(path, options.mask) for path in options.images])
        bar.show(0.5, "solving")
        wanted = [_palette(path, options.palette_mask) for path in options.palette]
        change = recoloring(own, wanted, options.weights, settings)
        bar.show(1.0, "done")
    return change


def _palette(path: Path, mask: Path | None) -> Palette:
    with _read(path, mask) as (picture, _image):
        return picture.palette()


@contextmanager
def _read(path: Path, mask: Path | None) -> Iterator[tuple[Picture, bpy.types.Image]]:
    """Read an image and its mask for as long as the context lasts."""
    with ExitStack() as stack:
        image = stack.enter_context(opened_image(path))
        own = None if mask is None else stack.enter_context(opened_image(mask))
        yield read_picture(image, own), image


def _recolored(options: Namespace, change: Recoloring | LookupTable, targets: Sequence[Path]) -> Iterator[Path]:
    """Write all images, and yield their paths."""
    if not targets:
        return
    with ProgressBar("Recoloring") as bar:
        if options.steps is not None:
            shares = np.linspace(0.0, change.settings.strength, options.steps)
            jobs = [
                (options.images[0], replace(change, settings=replace(change.settings, strength=float(share))))
                for share in shares
            ]
        else:
            jobs = [(path, change) for path in options.images]
        for place, ((path, own), target) in enumerate(zip(jobs, targets, strict=True)):
            with _read(path, options.mask) as (picture, image):
                save_pixels(_changed(picture, own, options.workers), image, target, options.depth)
            bar.show((place + 1) / len(jobs), target.name)
            yield target


def _changed(picture: Picture, change: Recoloring | LookupTable, workers: int | None) -> NDArray[np.float32]:
    out = np.empty_like(picture.pixels)
    for _ in recolored_blocks(picture.pixels, picture.pixel_format, change, picture.mask, out, workers=workers):
        pass
    return out
