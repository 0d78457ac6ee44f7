# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Colors with known palettes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from convwass_addon.applications.palettes.lab_colors import linear_of_lab, srgb_of_linear
from convwass_addon.applications.palettes.palette_statistics import Palette, measured_palette


def cloud(seed: int, mean: ArrayLike, spread: ArrayLike, count: int = 40_000) -> NDArray[np.float64]:
    """Return normally distributed colors in Lab, (3, count), with a mean and a (3, 3) square root of the covariance."""
    drawn = np.random.default_rng(seed).standard_normal((3, count))
    # Make mean and covariance exact, not only expected.
    drawn -= drawn.mean(axis=1, keepdims=True)
    drawn = np.linalg.solve(np.linalg.cholesky(np.cov(drawn)), drawn)
    return np.asarray(mean, float)[:, None] + np.asarray(spread, float) @ drawn


def palette_of(lab: NDArray[np.float64]) -> Palette:
    return measured_palette(lab)


def picture_of(lab: NDArray[np.float64], width: int) -> NDArray[np.float32]:
    """Return opaque sRGB pixels of colors, (height, width, 4)."""
    encoded = srgb_of_linear(linear_of_lab(lab))
    assert encoded.min() >= 0.0 and encoded.max() <= 1.0, "the colors can be shown"
    pixels = np.ones((lab.shape[1] // width, width, 4), dtype=np.float32)
    pixels[..., :3] = encoded.T.reshape(-1, width, 3)
    return pixels
