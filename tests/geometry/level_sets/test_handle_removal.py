# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Handles are removed where that moves the fewest cells to the other side of the level."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from convwass_addon.geometry.level_sets.handle_removal import FIRM, GENTLE, Effort, remove_handles

_LEVEL = 0.5


def _ring(shape: tuple[int, int, int], center: tuple[float, float, float], large: float, small: float) -> NDArray:
    """Return the cells of a solid torus around the third axis."""
    x, y, z = (axis - at for axis, at in zip(np.ogrid[tuple(slice(n) for n in shape)], center, strict=True))
    return np.hypot(np.hypot(x, y) - large, z) < small


@pytest.mark.parametrize("radius", [1.5, 2.6])
def test_of_a_thick_and_a_thin_handle_the_thin_one_is_cut(radius: float) -> None:
    """Although the density of the thick one is closer to the level, and also where that one could be cut as well."""
    thick = _ring((64, 40, 24), (20.0, 20.0, 12.0), 12.0, radius)
    thin = _ring((64, 40, 24), (42.0, 20.0, 12.0), 10.0, 1.1) & ~thick
    density = np.where(thick, 0.65, np.where(thin, 0.95, 0.0))
    changed = density.copy()
    assert remove_handles(changed, _LEVEL, 1) == 1
    lost = (density > _LEVEL) & (changed <= _LEVEL)
    assert (lost & thin).any()
    assert not (lost & thick).any()


def test_a_small_hole_is_filled_and_the_ring_beside_it_stays() -> None:
    """Although the density in the hole is far below the level."""
    shape = (64, 40, 24)
    ring = _ring(shape, (20.0, 20.0, 12.0), 12.0, 3.0)
    plate = np.zeros(shape, bool)
    plate[30:56, 10:30, 11:14] = True
    plate[44:46, 19:22] = False
    density = gaussian_filter((ring | plate).astype(float), 0.7)
    assert density[44, 20, 12] < 0.5 * _LEVEL
    changed = density.copy()
    assert remove_handles(changed, _LEVEL, 1) == 1
    assert changed[44, 20, 12] > _LEVEL
    assert not ((density > _LEVEL) & (changed <= _LEVEL)).any()


def _uneven_ring(thick: float, thin: float) -> NDArray:
    """Return the density of a ring whose radius falls from one side to the other."""
    x, y, z = (axis - 21.53 for axis in np.ogrid[:44, :44, :44])
    radius = 0.5 * (thick + thin) + 0.5 * (thick - thin) * x / np.maximum(np.hypot(x, y), 1e-9)
    return np.clip(0.5 - 0.5 * (np.hypot(np.hypot(x, y) - 11.0, z) - radius), 0.0, 1.0)


@pytest.mark.parametrize("effort", [GENTLE, FIRM])
def test_a_thread_of_a_ring_is_cut_but_not_a_limb(effort: Effort) -> None:
    """A cut that removes many cells takes away a part that is seen."""
    assert remove_handles(_uneven_ring(2.5, 0.8), _LEVEL, 1, effort) == 1
    limb = _uneven_ring(4.0, 2.0)
    assert remove_handles(limb, _LEVEL, 1, effort) == 0
    np.testing.assert_array_equal(limb, _uneven_ring(4.0, 2.0))
