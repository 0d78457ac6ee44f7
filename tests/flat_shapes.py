# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Flat shapes with known areas, holes and barycenters."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def ellipse(center=(0.0, 0.0), radii=(1.0, 1.0), corners: int = 256, angle: float = 0.0) -> NDArray[np.float64]:
    """Return a polygon with the exact area of the ellipse, (corners, 2), counterclockwise."""
    step = 2 * np.pi / corners
    turned = np.arange(corners) * step
    # Enlarged, because an inscribed polygon has less area than the circle.
    grown = np.sqrt(step / np.sin(step))
    ring = grown * np.stack([radii[0] * np.cos(turned), radii[1] * np.sin(turned)], axis=1)
    c, s = np.cos(angle), np.sin(angle)
    return ring @ np.array([[c, s], [-s, c]]) + np.asarray(center)


def rectangle(low=(0.0, 0.0), high=(1.0, 1.0)) -> NDArray[np.float64]:
    """Return the corners, (4, 2), counterclockwise."""
    return np.array([[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]], dtype=np.float64)


def star(points: int = 5, turns: int = 2) -> NDArray[np.float64]:
    """Return a self-intersecting star polygon in the unit circle."""
    angles = np.arange(points) * 2 * np.pi * turns / points
    return np.stack([np.cos(angles), np.sin(angles)], axis=1)
