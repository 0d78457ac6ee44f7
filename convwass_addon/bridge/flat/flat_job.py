# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Morph flat objects of the scene into curves, meshes or drawings; see :mod:`.morphs.job`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import get_args

import bpy

from ...applications.flat.flat_morph import flat_morph
from ...applications.flat.flat_settings import FlatSettings
from ...applications.morphs.computation import USUAL_COMPUTATION, Computation
from ...applications.morphs.layouts import Blend
from ...errors import InputError
from ...progress import UNINTERRUPTED, Control, Work
from ..morphs.inputs.animated_inputs import animation_notices
from .color_notices import color_notices, line_notices
from .flat_bake import FlatBake, FlatKind, shared_material
from .flat_curves import FittedFrame
from .flat_moves import moved_flats
from .flat_objects import flat_objects
from .flat_writing import WritesFlatFrames
from .pencil_bake import PencilBake


class FlatJob(WritesFlatFrames):
    """Bakes flat shapes. All methods except :meth:`steps` must be called on the main thread.

    Parameters
    ----------
    inputs, blends, options, first_frame
        As for :class:`.job.MorphJob`; `options` also contains `flat_output`: "CURVE", "MESH" or "DRAWING".
    settings : FlatSettings
        Settings of the morph.

    Raises
    ------
    InputError
        An input fills no area or does not lie in a plane, or a text has no letters.
    """

    def __init__(
        self,
        inputs: Sequence[bpy.types.Object],
        blends: Sequence[Blend],
        settings: FlatSettings,
        options: dict[str, object],
        first_frame: int,
    ) -> None:
        if len(inputs) < 2:
            raise InputError("A morph needs at least two shapes; select or name another one.")
        self.records: list[dict[str, object]] = []
        self._names = [obj.name for obj in inputs]
        read = flat_objects(inputs, bpy.context.evaluated_depsgraph_get())
        self.notices = [flat.read.notice for flat in read if flat.read.notice is not None]
        self.notices += animation_notices(inputs)
        alignment, scaling = (str(options.get(name, "PLACED")) for name in ("alignment", "scaling"))
        flats = moved_flats(read, alignment, scaling)
        self._shapes = [flat.shape for flat in flats]
        self._blends = blends
        self._settings = settings
        chosen = options.get("flat_output")
        self.kind: FlatKind = chosen if chosen in get_args(FlatKind) else "CURVE"
        if self.kind == "DRAWING" or shared_material(inputs) is None:
            self.notices += color_notices(inputs)
        if self.kind != "DRAWING":
            self.notices += line_notices(read, self._names)
        stored = {**settings.as_dict(), **options, "flat": True}
        bake = PencilBake if self.kind == "DRAWING" else FlatBake
        self._bake = bake.begin_flat(inputs, blends, stored, first_frame, flats, self.kind)

    def steps(self, control: Control = UNINTERRUPTED, computation: Computation = USUAL_COMPUTATION) -> Work[None]:
        """Compute the frames without accessing Blender's data; see :func:`.flat_morph.flat_morph`."""
        workers, wanted = computation.workers, computation.wanted
        work = flat_morph(
            self._shapes, self._names, self._blends, self._settings, control, workers=workers, wanted=wanted
        )
        # Fit the curves here, in the background, rather than when the objects are made.
        for report in work:
            frame = report.payload
            yield report if frame is None else replace(report, payload=FittedFrame.of(frame, self._settings.fit_error))
