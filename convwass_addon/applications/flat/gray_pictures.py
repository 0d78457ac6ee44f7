# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Convert blends of gray images to pictures (Solomon et al. 2015, Fig. 13): fullness and color of every pixel."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ...geometry.plane.coverage import coverage
from ...geometry.plane.planar_fill import filled_boundary
from .flat_colors import carried_colors
from .flat_frames import FlatDensity, FlatFrame
from .flat_shapes import FlatInput
from .gray_images import regraded

Grays = Literal["images", "density", "threshold"]
"""What becomes of a density: the grays of the inputs, itself, or black and white."""

# Pixels with less ink show only the ground.
_LEAST_FULL = 1.0 / 512.0
_INK = (0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True)
class PictureMaker:
    """Paints the frames of one morph.

    Attributes
    ----------
    shapes : sequence of FlatShape or FlatImage
        The inputs; their colors are those of the ink.
    grounds : (k, 4) float64
        Red, green, blue, opacity of the inputs' backgrounds, in the same space as their colors.
    ends : sequence of FlatDensity
        Densities of the unblended inputs.
    grays : "images", "density" or "threshold"
        How densities are converted.
    """

    shapes: Sequence[FlatInput]
    grounds: NDArray[np.float64]
    ends: Sequence[FlatDensity]
    grays: Grays

    def picture(self, frame: FlatFrame) -> NDArray[np.float32]:
        """Paint a frame that has a density.

        Every pixel gets ink with the color at its origin, as far as it is full, over the mean of the inputs'
        backgrounds.

        Returns
        -------
        (height, width, 4) float32
            Red, green, blue, opacity, rows from the bottom up.

        Raises
        ------
        InputError
            A frame without a density.
        """
        full = np.clip(self._fullness(frame), 0.0, 1.0)
        weights = np.asarray(frame.blend.weights)
        # Colors are premultiplied by opacity for mixing.
        ground = np.append(weights @ (self.grounds[:, :3] * self.grounds[:, 3:]), weights @ self.grounds[:, 3])
        result = np.tile(ground, (*full.shape, 1))
        inked = np.argwhere(full >= _LEAST_FULL)
        points = (inked + 0.5) * frame.density.pixel + np.asarray(frame.density.corner)
        ink = carried_colors(points, frame, self.shapes)
        covered = full[tuple(inked.T)][:, None]
        color = np.array([_INK]) if ink is None else np.clip(np.c_[ink[:, :3], np.ones(len(ink))], 0.0, 1.0)
        result[tuple(inked.T)] += covered * (color - ground)
        opacity = result[..., 3:]
        np.divide(result[..., :3], opacity, out=result[..., :3], where=opacity > 0)
        return np.ascontiguousarray(result.swapaxes(0, 1), dtype=np.float32)

    def _fullness(self, frame: FlatFrame) -> NDArray[np.floating]:
        """Return the fullness of every pixel of a frame, (nx, ny)."""
        if self.grays == "threshold" and frame.outline is not None:
            density = frame.density
            boundary = filled_boundary(list(frame.outline.rings), "non-zero")
            moved = boundary.moved(-np.asarray(density.corner) / density.pixel, 1.0 / density.pixel)
            return coverage(moved, density.values.shape)
        if self.grays == "images" and frame.blend.source is None:
            return regraded(frame, self.ends).values
        return frame.density.values
