# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Level fields with a closed form."""

from __future__ import annotations

import numpy as np
from scipy.special import ndtr

from convwass_addon.applications.live.level_fields import FieldBox, LevelField
from convwass_addon.geometry.level_sets.isosurface import surface_enclosing

BOX = FieldBox(np.array([-3, 2, 0]), (30, 28, 32))
CENTER = np.array([12.2, 15.7, 16.1])
"""Of all balls, in cells of the common grid."""


def ball_field(radius: float, center: np.ndarray = CENTER, box: FieldBox = BOX) -> LevelField:
    """Return the field of a ball of cells, as its blurred occupancy gives it, cut off by a box."""
    low = np.array([-1, 3, 1])
    cells = np.moveaxis(np.indices((27, 26, 29)), 0, -1) + low + 0.5
    density = ndtr((radius - np.linalg.norm(cells - center, axis=-1)) / 0.8)
    volume = 4.0 / 3.0 * np.pi * radius**3
    return LevelField.of(density, low, surface_enclosing(density, volume).level, volume, box)


def radius_of(volume: float) -> float:
    """Return the radius of a ball."""
    return float(np.cbrt(0.75 * volume / np.pi))
