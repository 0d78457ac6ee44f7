# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Give a blurred density the gray values of the inputs (Solomon et al. 2015, Fig. 13)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...errors import InputError
from .flat_frames import FlatDensity, FlatFrame


def regraded(frame: FlatFrame, ends: Sequence[FlatDensity]) -> FlatDensity:
    """Give the density of a blend the gray values of the inputs, keeping the order of its pixels from dark to bright.

    The brightest pixel gets the weighted mean of the inputs' brightest pixels, the second brightest that of the second
    brightest, and so on: the barycenter of their histograms.

    Parameters
    ----------
    frame : FlatFrame
        A blend with a density.
    ends : sequence of FlatDensity
        Densities of all unblended inputs, from the same morph.

    Raises
    ------
    InputError
        The frame has no density, or the densities belong to another morph.
    """
    if frame.density is None:
        raise InputError("These frames have outlines only; make them again as densities.")
    values = frame.density.values
    if len(ends) != len(frame.blend.weights) or any(end.values.shape != values.shape for end in ends):
        raise InputError("The densities of the inputs must come from the same morph.")
    grays = sum(weight * np.sort(end.values, axis=None) for weight, end in zip(frame.blend.weights, ends, strict=True))
    result = np.empty(values.size, np.float32)
    result[np.argsort(values, axis=None, kind="stable")] = grays
    return FlatDensity(result.reshape(values.shape), frame.density.pixel, frame.density.corner)
