# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A first, coarse preview of one blend of a morph, within a second."""

from __future__ import annotations

from dataclasses import replace

from ...errors import InputError, ResourceError
from ...progress import UNINTERRUPTED, Control
from .blending import sketch_blends
from .layouts import Blend
from .morph_inputs import MorphInputs
from .morph_problem import MorphFrame, MorphProblem
from .morph_settings import MorphSettings
from .parts import joined, voxelized_parts
from .volumes import Lattice

# Cells along the longest side; a preview is made only if the morph is finer by this factor.
_RESOLUTION, _FINER = 64, 1.25


def first_preview(
    inputs: MorphInputs, blend: Blend, settings: MorphSettings, control: Control = UNINTERRUPTED
) -> MorphFrame | None:
    """Solve a blend at a coarse resolution, which takes about a fifth of a second.

    Parameters
    ----------
    inputs, settings, control
        As for :func:`.morph.morph`.
    blend : Blend
        The blend to preview.

    Returns
    -------
    MorphFrame or None
        For display only. None if the morph itself is hardly finer, if the blend is one of the shapes, or if the shapes
        are too thin for this resolution.
    """
    if settings.resolution < _FINER * _RESOLUTION or blend.source is not None:
        return None
    shapes, matching = inputs.shapes, inputs.matching
    coarse = replace(settings, resolution=_RESOLUTION, blur=None)
    lattice = Lattice.around(shapes, coarse.resolution, coarse.sigma, 1, matching.count)
    try:
        volumes = []
        for index, (shape, name) in enumerate(zip(shapes, inputs.names, strict=True)):
            volumes.append(voxelized_parts(shape, name, index, lattice, coarse.thickness, matching, control))
            control.check()
        problem = MorphProblem.for_sketches(joined(matching, volumes), lattice, coarse)
        frame = next(iter(sketch_blends(problem, [blend], control))).frame
    except (InputError, ResourceError):
        return None
    return None if frame.mesh is None else frame
