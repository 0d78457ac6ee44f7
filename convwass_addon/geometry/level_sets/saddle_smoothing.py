# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Smooth a density only where its level sets are spongy."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, gaussian_filter

from .saddles import bridges, lids

# Saddles within this ratio of the level, on either side, may form a sponge; the density is smoothed within this many
# cells of them.
_NEAR = 0.75
_AROUND = 3


def smoothed_at_saddles(density: NDArray[np.floating], level: float, sigma: float) -> NDArray[np.floating]:
    """Return a density that is smoothed around its saddles near a level and blends into the given one elsewhere.

    Parameters
    ----------
    density : (nx, ny, nz)
        Nonnegative.
    level : float
        Level of the surface.
    sigma : float
        Standard deviation of the Gaussian, in cells.
    """
    saddles = np.concatenate([find(density, level * _NEAR, level / _NEAR) for find in (bridges, lids)])
    near = np.zeros(density.shape, bool)
    near[tuple(saddles.T)] = True
    share = gaussian_filter(binary_dilation(near, iterations=_AROUND).astype(density.dtype), 1.0)
    return density + share * (gaussian_filter(density, sigma) - density)
