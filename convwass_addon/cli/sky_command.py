# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The command ``sky``."""

from __future__ import annotations

from argparse import Namespace

from ..applications.skies.sky_frames import require_light
from ..applications.skies.sky_settings import SkySettings
from ..applications.whole_paths import whole_path
from ..bridge.skies.sky_pixels import read_sky_file, resized
from ..bridge.skies.sky_sequence import PlacedSky, SkyFiles, fitting_height, sky_steps
from ..console import ProgressBar
from ..errors import InputError
from ..progress import payloads
from .answer import Answer
from .from_schema import given_settings
from .overwriting import refuse_overwriting
from .reports import note_leftovers


def run_sky(options: Namespace) -> Answer:
    """Interpolate skies and write the images.

    Raises
    ------
    InputError
        The images or options cannot be used.
    """
    if len(options.skies) < 2:
        raise InputError("Name at least two images.")
    if options.steps < 2:
        raise InputError("--steps must be 2 or more.")
    if options.first < 0:
        raise InputError("--first must be 0 or more; names of files have no negative numbers.")
    if options.width is not None and not 64 <= options.width <= 16384:
        raise InputError("--width must be 64 to 16384.")
    settings = SkySettings(**given_settings(options, SkySettings))
    files = SkyFiles(whole_path(options.out), options.first, options.steps)
    refuse_overwriting(options.skies, files.paths)
    skies = [read_sky_file(path) for path in options.skies]
    for path, sky in zip(options.skies, skies, strict=True):
        require_light(sky, path.name)
    height = fitting_height(options.width or skies[0].shape[1], settings)
    records = []
    try:
        with ProgressBar("Blending skies") as bar:
            work = bar.shown(sky_steps([resized(sky, height) for sky in skies], options.steps, settings))
            for made in payloads(work, PlacedSky):
                files.write(made)
                records.append(made.frame.record)
        files.finish()
    except BaseException:
        files.discard()
        raise
    note_leftovers(files.paths)
    record = {"skies": [str(path) for path in options.skies], "frames": records}
    return Answer.of_files(record, files.paths)
