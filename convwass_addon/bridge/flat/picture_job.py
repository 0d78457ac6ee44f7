# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Morph flat objects of the scene into pictures; see :mod:`.morphs.job`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np

from ...applications.flat.flat_frames import FlatFrame
from ...applications.flat.flat_morph import flat_morph
from ...applications.flat.flat_settings import FlatSettings
from ...applications.flat.gray_pictures import PictureMaker
from ...applications.morphs.computation import USUAL_COMPUTATION, Computation
from ...applications.morphs.layouts import Blend
from ...errors import InputError
from ...progress import UNINTERRUPTED, Control, Work, payloads
from ...sentence import Sentence
from ..morphs.disk.disk_output import named_folder
from .flat_writing import WritesFlatFrames
from .gray_inputs import gray_inputs
from .picture_bake import PictureBake, PictureFrame


class PictureJob(WritesFlatFrames):
    """Bakes flat shapes as pictures. All methods except :meth:`steps` must be called on the main thread.

    Pictures are placed on the center of mass of the first shape.

    Parameters
    ----------
    inputs, blends, settings, options, first_frame
        As for :class:`.flat_job.FlatJob`; `options` also contains `grays`, "IMAGES", "DENSITY" or "THRESHOLD", and
        `folder`.
    replaces : bpy.types.Collection, optional
        A morph to replace with its files.
    folder_of : callable
        Returns the folder for the files of a morph in another one: `named_folder`, whose files are replaced, or
        :func:`.disk_output.own_folder`.

    Raises
    ------
    InputError
        An input cannot be read or is empty, letters are requested from images, or the folder cannot be used.
    """

    kind = "PICTURE"

    def __init__(
        self,
        inputs: Sequence[bpy.types.Object],
        blends: Sequence[Blend],
        settings: FlatSettings,
        options: dict[str, object],
        first_frame: int,
        replaces: bpy.types.Collection | None = None,
        folder_of: Callable[[str, bpy.types.Collection], Path] = named_folder,
    ) -> None:
        if len(inputs) < 2:
            raise InputError("A morph needs at least two shapes; select or name another one.")
        self.records: list[dict[str, object]] = []
        self.notices: list[Sentence] = []
        self._names = [obj.name for obj in inputs]
        self._inputs = gray_inputs(inputs, bpy.context.evaluated_depsgraph_get())
        self._blends = blends
        # Carrying is needed for the colors of ink.
        self._settings = replace(settings, output="densities", carry=True)
        self._grays = str(options.get("grays") or "IMAGES").lower()
        stored = {**settings.as_dict(), **options, "flat": True}
        self._bake = PictureBake.begin_pictures(inputs, blends, stored, first_frame, self._inputs, replaces, folder_of)

    def steps(self, control: Control = UNINTERRUPTED, computation: Computation = USUAL_COMPUTATION) -> Work[None]:
        """Compute the frames without accessing Blender's data; see :meth:`.flat_job.FlatJob.steps`."""
        shapes = [own.shape for own in self._inputs]
        count = len(shapes)
        alone = [Blend(tuple(float(other == own) for other in range(count))) for own in range(count)]
        given = payloads(flat_morph(shapes, self._names, alone, self._settings, control), FlatFrame)
        ends = [frame.density for frame in given]
        grounds = np.array([own.ground for own in self._inputs])
        maker = PictureMaker(shapes, grounds, ends, self._grays)
        workers, wanted = computation.workers, computation.wanted
        for report in flat_morph(
            shapes, self._names, self._blends, self._settings, control, workers=workers, wanted=wanted
        ):
            frame = report.payload
            if frame is None:
                yield report
            else:
                yield replace(report, payload=PictureFrame(**vars(frame), pixels=maker.picture(frame)))
