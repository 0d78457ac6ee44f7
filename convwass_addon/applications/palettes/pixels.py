# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Encodings of pixels in files: color encoding, alpha and primaries."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .lab_colors import lab_of_linear, linear_of_srgb, srgb_of_linear, transformed
from .palette_statistics import Palette, measured_palette, sample_places


@dataclass(frozen=True)
class PixelFormat:
    """Meaning of an image's values.

    Attributes
    ----------
    encoding : "srgb" or "linear"
        Whether the sRGB transfer function was applied.
    alpha : "straight", "associated" or "ignored"
        Whether colors were multiplied by alpha; "ignored" counts all pixels equally.
    to_rec709 : (3, 3) float64
        Matrix from the primaries of linear values to those of Rec.709.
    highest : float
        Largest value of a channel; infinite for scenes, which may be brighter than white.
    levels : int
        Number of steps from 0 to 1 for quantized images, such as 255 for bytes; 0 for floats.
    """

    encoding: Literal["srgb", "linear"] = "srgb"
    alpha: Literal["straight", "associated", "ignored"] = "straight"
    to_rec709: NDArray[np.float64] = field(default_factory=lambda: np.eye(3))
    highest: float = 1.0
    levels: int = 0

    def linear(self, pixels: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return the colors of pixels, (..., 4), as linear Rec.709, (3, ...); values that are not finite stay so."""
        colors = self._straight(pixels)
        if self.encoding == "srgb":
            colors = linear_of_srgb(colors)
        return colors if self._is_rec709 else transformed(self.to_rec709, colors)

    def encoded(self, linear: NDArray[np.float32], alpha: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return pixel values for colors in linear Rec.709, (3, ...), with the given alpha."""
        colors = linear if self._is_rec709 else transformed(np.linalg.inv(self.to_rec709), linear)
        if self.encoding == "srgb":
            colors = srgb_of_linear(colors)
        return self._with_alpha(colors, alpha)

    def displayed(self, pixels: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return the colors of pixels, (..., 4), sRGB-encoded, (3, ...); values that are not finite stay so."""
        return self._straight(pixels) if self._is_srgb else srgb_of_linear(self.linear(pixels))

    def encoded_displayed(self, displayed: NDArray[np.float32], alpha: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return pixel values for sRGB-encoded colors, (3, ...), with the given alpha."""
        if self._is_srgb:
            return self._with_alpha(displayed, alpha)
        return self.encoded(linear_of_srgb(displayed), alpha)

    def _straight(self, pixels: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return red, green and blue, (3, ...), not multiplied by alpha."""
        # Always copy, even if the view of a single pixel is contiguous, because the result is modified.
        colors = np.moveaxis(pixels[..., :3], -1, 0).copy(order="C")
        if self.alpha == "associated":
            alpha = pixels[..., 3]
            colors /= np.where(alpha > 0, alpha, 1.0)
        return colors

    def _with_alpha(self, colors: NDArray[np.float32], alpha: NDArray[np.float32]) -> NDArray[np.float32]:
        """Invert `_straight`."""
        if self.alpha == "associated":
            colors = colors * np.where(alpha > 0, alpha, 1.0)
        return np.moveaxis(colors, 0, -1)

    @property
    def _is_srgb(self) -> bool:
        return self.encoding == "srgb" and self._is_rec709

    @property
    def _is_rec709(self) -> bool:
        return np.array_equal(self.to_rec709, np.eye(3))


def image_palette(
    pixels: ArrayLike, pixel_format: PixelFormat, mask: ArrayLike | None = None, weights: ArrayLike | None = None
) -> Palette:
    """Measure the palette of an image, from all of its pixels or a sample of about 260 000.

    Parameters
    ----------
    pixels : (..., 4) array_like
        Red, green, blue, alpha.
    pixel_format : PixelFormat
        Meaning of the values.
    mask : array_like, optional
        Nonnegative weights of the pixels, in addition to their alpha.
    weights : array_like, optional
        Further weights, such as the areas of the vertices of a mesh.

    Raises
    ------
    InputError
        No pixel counts.
    """
    rows = np.asarray(pixels, dtype=np.float32).reshape(-1, 4)
    places = sample_places(len(rows))
    chosen = rows[places]
    shares = np.ones(len(chosen)) if pixel_format.alpha == "ignored" else np.clip(chosen[:, 3], 0.0, 1.0)
    for own in (mask, weights):
        if own is not None:
            shares = shares * np.asarray(own).reshape(-1)[places]
    with np.errstate(invalid="ignore", over="ignore"):
        lab = lab_of_linear(pixel_format.linear(chosen))
    return measured_palette(lab, shares)
