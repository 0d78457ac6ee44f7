# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""All that a material between others is made of, step by step."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...sentence import Sentence
from .ggx_fit import GgxFit, fit_ggx
from .lobe_interpolation import InterpolatedLobes, LobeBlend, blend_weights
from .lobe_lookup import half_angle_table
from .lobe_table import LobeTable
from .materials import Material
from .reflectance_settings import ReflectanceSettings

# Share of the work that tabulating the materials takes.
_TABULATING = 0.1


@dataclass(frozen=True)
class LobeFrame:
    """A material at one blend.

    Attributes
    ----------
    weights : (k,) float64
        Sum 1.
    table : LobeTable
        Its lobes.
    image : (64, 256, 3) float32 or None
        By half and difference angle; None where there is a grain.
    fit : GgxFit
        The nearest GGX.
    record : dict
        Ready for JSON.
    notices : tuple of Sentence
        What the user should know.
    """

    weights: NDArray[np.float64]
    table: LobeTable
    image: NDArray[np.float32] | None
    fit: GgxFit
    record: dict[str, object]
    notices: tuple[Sentence, ...]


@dataclass(frozen=True)
class LobeFrameStep:
    """One step.

    Attributes
    ----------
    fraction : float
        Done share of the whole job.
    message : Sentence
        What is being done.
    frame : LobeFrame or None
        A finished blend.
    """

    fraction: float
    message: Sentence
    frame: LobeFrame | None = None


def path_weights(steps: int, count: int) -> NDArray[np.float64]:
    """Weights on the way from the first of so many materials through the others to the last, (steps, count)."""
    places = np.linspace(0.0, count - 1.0, steps)
    return np.maximum(0.0, 1.0 - np.abs(places[:, None] - np.arange(count)))


def lobe_frames(
    materials: Sequence[Material], weights: NDArray[np.float64], settings: ReflectanceSettings
) -> Iterator[LobeFrameStep]:
    """Interpolate materials at one or more weights.

    Parameters
    ----------
    materials : sequence of Material
        Two to four.
    weights : (n, k)
        One row for every blend.
    settings : ReflectanceSettings
        How.

    Yields
    ------
    LobeFrameStep
        Progress; with the last step of every blend the result.

    Raises
    ------
    InputError
        Materials or weights that cannot be used.
    """
    for row in weights:
        blend_weights(row, len(materials))
    yield LobeFrameStep(0.0, Sentence("Tabulating materials"))
    yield from blended_frames(LobeBlend.of(materials, settings), weights)


def blended_frames(blend: LobeBlend, weights: NDArray[np.float64]) -> Iterator[LobeFrameStep]:
    """Do the same with materials that are tabulated already."""
    rows = [blend_weights(row, len(blend.tables)) for row in weights]
    before: InterpolatedLobes | None = None
    for index, row in enumerate(rows):
        for step in blend.steps(row, before):
            before = step.found or before
            if step.found is None:
                share = (index + step.fraction) / len(rows)
                values = {"done": index + 1, "total": len(rows), "what": step.message}
                message = Sentence("Blend {done} of {total}: {what}", values)
                yield LobeFrameStep(_TABULATING + (1.0 - _TABULATING) * share, message)
        share = _TABULATING + (1.0 - _TABULATING) * (index + 1) / len(rows)
        yield LobeFrameStep(share, Sentence("Fitting"), _frame(row, before))


def _frame(weights: NDArray[np.float64], found: InterpolatedLobes) -> LobeFrame:
    table = found.table
    fit = fit_ggx(table)
    image = half_angle_table(table) if table.is_isotropic else None
    record = {**found.record, "fit": fit.record()}
    return LobeFrame(weights, table, image, fit, record, found.notices)
