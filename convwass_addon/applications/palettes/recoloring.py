# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Maps between palettes, solved once and applied to any number of pixels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...progress import UNINTERRUPTED, Control
from ..blend_weights import normalized_weights
from .chroma_map import ChromaMap, chroma_barycenter, chroma_map
from .lab_colors import lab_of_linear, linear_of_lab
from .lightness_curve import LightnessCurve, lightness_curve
from .palette_settings import RecolorSettings
from .palette_statistics import Palette

# Bisection steps for the largest displayable chroma.
_HALVINGS = 10
# Changes below this in all channels leave a pixel unchanged.
_NOTHING = 1e-9
# L of white, plus rounding.
_WHITE = 100.01


@dataclass(frozen=True)
class Recoloring:
    """A map from one palette to another.

    The change of a color is proportional to the strength, so another strength needs no new solve. Between two palettes
    this yields the sequence of their barycenters (Solomon et al. 2015, section 7 and Fig. 11).

    Attributes
    ----------
    lightness : LightnessCurve
        Change of L.
    chroma : ChromaMap
        Change of a and b.
    settings : RecolorSettings
        Settings of its application.
    """

    lightness: LightnessCurve
    chroma: ChromaMap
    settings: RecolorSettings

    @property
    def record(self) -> dict[str, object]:
        """JSON-ready figures of the solve."""
        return {"iterations": self.chroma.iterations, "marginal_error": self.chroma.marginal_error}

    def shifts(self, lab: NDArray[np.floating]) -> NDArray[np.floating]:
        """Return the changes of colors, (3, ...), at the strength of the settings."""
        found = np.empty_like(lab)
        found[0] = self.lightness(lab[0]) if self.settings.lightness == "transport" else 0.0
        found[1:] = self.chroma(lab[1:])
        found *= self.settings.strength
        return found

    def finished(
        self, linear: NDArray[np.floating], lab: NDArray[np.floating], shifts: NDArray[np.floating], highest: float
    ) -> NDArray[np.floating]:
        """Return shifted colors in linear Rec.709, mapped into the gamut.

        Parameters
        ----------
        linear, lab : (3, ...) array
            The original colors.
        shifts : (3, ...) array
            Their changes.
        highest : float
            Largest value of a channel; infinite for scenes.
        """
        moved = lab + shifts
        lowest = np.minimum(linear, 0.0)
        if self.settings.gamut == "chroma":
            _reduce_chroma(moved, lowest, highest)
        found = np.clip(linear_of_lab(moved), lowest, highest)
        return np.where((np.abs(shifts) <= _NOTHING).all(axis=0), linear, found)

    def __call__(self, linear: NDArray[np.floating], highest: float = 1.0) -> NDArray[np.floating]:
        """Return recolored pixels, (3, ...), linear Rec.709."""
        lab = lab_of_linear(linear)
        return self.finished(linear, lab, self.shifts(lab), highest)


def recoloring(
    source: Palette,
    targets: Sequence[Palette],
    weights: Sequence[float] | None = None,
    settings: RecolorSettings | None = None,
    control: Control = UNINTERRUPTED,
) -> Recoloring:
    """Solve for the map from a palette to another one, or to the barycenter of several.

    Parameters
    ----------
    source : Palette
        Palette of the image to recolor.
    targets : sequence of Palette
        One or more.
    weights : sequence of float, optional
        Their weights in the barycenter, nonnegative; by default equal.
    settings : RecolorSettings, optional
        Settings of the recoloring.
    control : Control
        Stops the solve when cancelled.

    Raises
    ------
    InputError
        No palette, or invalid weights.
    """
    settings = settings or RecolorSettings()
    target = palette_barycenter(targets, weights, control)
    own = source.lightness
    if target.lightness[-1] <= _WHITE:
        # If the palette has nothing brighter than white, bright lamps of a scene keep their excess over white.
        own = np.minimum(own, _WHITE)
    return Recoloring(
        lightness_curve(own, target.lightness, settings.smoothing, settings.steepest),
        chroma_map(source.chroma, target.chroma, settings.smoothing, control),
        settings,
    )


def palette_barycenter(
    palettes: Sequence[Palette], weights: Sequence[float] | None = None, control: Control = UNINTERRUPTED
) -> Palette:
    """Return the barycenter of palettes: debiased in a and b, in closed form in L.

    Raises
    ------
    InputError
        No palette, or invalid weights.
    """
    if not palettes:
        raise InputError("There is no palette; choose an image that has the desired colors.")
    alphas = normalized_weights(np.ones(len(palettes)) if weights is None else weights, len(palettes))
    chosen = [palette for palette, alpha in zip(palettes, alphas, strict=True) if alpha > 0]
    alphas = alphas[alphas > 0]
    if len(chosen) == 1:
        return chosen[0]
    chroma = chroma_barycenter([palette.chroma for palette in chosen], alphas, control)
    lightness = alphas @ np.array([palette.lightness for palette in chosen])
    return Palette(chroma, lightness, float(alphas @ [palette.mass for palette in chosen]))


def _reduce_chroma(lab: NDArray[np.floating], lowest: NDArray[np.floating], highest: float) -> None:
    """Reduce the chroma of colors outside the gamut until they can be displayed; L is kept, clipped to the gamut's."""
    if np.isfinite(highest):
        np.clip(lab[0], 0.0, 100.0, out=lab[0])
    slack = 1e-4
    linear = linear_of_lab(lab)
    outside = ((linear < lowest - slack) | (linear > highest + slack)).any(axis=0)
    if not outside.any():
        return
    own, floor = lab[:, outside], lowest[:, outside]
    low, high = np.zeros_like(own[0]), np.ones_like(own[0])
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        tried = linear_of_lab(np.stack([own[0], own[1] * middle, own[2] * middle]))
        fits = ((tried >= floor - slack) & (tried <= highest + slack)).all(axis=0)
        low, high = np.where(fits, middle, low), np.where(fits, high, middle)
    lab[1, outside], lab[2, outside] = own[1] * low, own[2] * low
