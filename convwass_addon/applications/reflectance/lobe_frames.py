# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compute all outputs for an interpolated material, step by step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...one_line import one_line
from ...progress import UNINTERRUPTED, Control, Progress, Work, as_part, within
from ...sentence import Sentence
from .ggx_fit import GgxFit, fit_ggx
from .lobe_interpolation import InterpolatedLobes, LobeBlend, blend_weights
from .lobe_lookup import half_angle_table
from .lobe_table import LobeTable
from .materials import Material
from .reflectance_settings import ReflectanceSettings

# Fraction of the work for tabulating the materials.
_TABULATING = 0.1


@dataclass(frozen=True)
class LobeFrame:
    """A material at one blend.

    Attributes
    ----------
    weights : (k,) float64
        Of sum 1.
    table : LobeTable
        The lobes of the material.
    image : (64, 256, 3) float32 or None
        Reflectance by half and difference angle; None for anisotropic materials.
    fit : GgxFit
        The best-fitting GGX material.
    record : dict
        JSON-ready figures.
    notices : tuple of Sentence
        Warnings for the user.
    """

    weights: NDArray[np.float64]
    table: LobeTable
    image: NDArray[np.float32] | None
    fit: GgxFit
    record: dict[str, object]
    notices: tuple[Sentence, ...]

    __repr__ = one_line("weights", "table", "image", "notices")


def path_weights(steps: int, count: int) -> NDArray[np.float64]:
    """Weights along a path through `count` materials, from the first to the last, (steps, count)."""
    places = np.linspace(0.0, count - 1.0, steps)
    return np.maximum(0.0, 1.0 - np.abs(places[:, None] - np.arange(count)))


def lobe_frames(
    materials: Sequence[Material],
    weights: NDArray[np.float64],
    settings: ReflectanceSettings,
    control: Control = UNINTERRUPTED,
) -> Work[None]:
    """Interpolate materials at one or more weights.

    Parameters
    ----------
    materials : sequence of Material
        Two to four.
    weights : (n, k)
        One row per blend.
    settings : ReflectanceSettings
        Settings of the interpolation.
    control : Control
        Stops the work when cancelled.

    Yields
    ------
    Progress
        The payloads are the finished blends, as :class:`LobeFrame`, in the order of `weights`.

    Raises
    ------
    InputError
        Invalid materials or weights.
    """
    for row in weights:
        blend_weights(row, len(materials))
    yield Progress(0.0, Sentence("Tabulating materials"))
    yield from within(blended_frames(LobeBlend.of(materials, settings), weights, control), _TABULATING, 1.0)


def blended_frames(blend: LobeBlend, weights: NDArray[np.float64], control: Control = UNINTERRUPTED) -> Work[None]:
    """Like :func:`lobe_frames`, for materials that are already tabulated."""
    rows = [blend_weights(row, len(blend.tables)) for row in weights]
    before: InterpolatedLobes | None = None
    for index, row in enumerate(rows):
        work = as_part(blend.steps(row, before, control), index, len(rows))
        before = yield from _numbered(work, index + 1, len(rows))
        yield Progress((index + 1) / len(rows), Sentence("Fitting"), _frame(row, before))


def _numbered(work: Work[InterpolatedLobes], number: int, total: int) -> Work[InterpolatedLobes]:
    """Add the number of the blend to progress messages."""
    while True:
        try:
            report = next(work)
        except StopIteration as end:
            return end.value
        values = {"done": number, "total": total, "what": report.message}
        yield replace(report, message=Sentence("Blend {done} of {total}: {what}", values))


def _frame(weights: NDArray[np.float64], found: InterpolatedLobes) -> LobeFrame:
    table = found.table
    fit = fit_ggx(table)
    image = half_angle_table(table) if table.is_isotropic else None
    record = {**found.record, "fit": fit.record()}
    return LobeFrame(weights, table, image, fit, record, found.notices)
