# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Equirectangular pictures of the whole sky: resizing, integration, and drawing discs."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from ...transport.sphere import solid_angles

# Luminance of linear Rec. 709.
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
# Points along each side of a pixel that are tested against a disc.
_POINTS = 8


def shrunk(image: NDArray[np.float64], rows: int) -> NDArray[np.float64]:
    """Means over blocks by solid angle, (rows, 2 rows, ...); the picture's height must be a multiple of `rows`."""
    height, width = image.shape[:2]
    down, across = height // rows, width // (2 * rows)
    rest = image.shape[2:]
    areas = solid_angles(height, width).reshape(height, width, *(1 for _ in rest))
    sums = (image * areas).reshape(rows, down, 2 * rows, across, *rest).sum(axis=(1, 3))
    return sums / solid_angles(rows, 2 * rows).reshape(rows, 2 * rows, *(1 for _ in rest))


def padded(image: NDArray[np.float64], margin: int) -> NDArray[np.float64]:
    """Pad a picture, (rows, columns), around the seam and across the poles, half a turn away."""
    half = image.shape[1] // 2
    north, south = (np.roll(part[::-1], half, axis=1) for part in (image[:margin], image[-margin:]))
    tall = np.concatenate([north, image, south])
    return np.concatenate([tall[:, -margin:], tall, tall[:, :margin]], axis=1)


def enlarged(image: NDArray[np.float64], height: int, width: int) -> NDArray[np.float64]:
    """Interpolate a picture, (rows, columns), linearly to another size."""
    rows, columns = image.shape
    down = (np.arange(height) + 0.5) * (rows / height) + 1.5
    across = (np.arange(width) + 0.5) * (columns / width) + 1.5
    places = np.broadcast_arrays(down[:, None], across)
    return map_coordinates(padded(image, 2), np.stack(places), order=1)


def light_of(image: NDArray[np.float64]) -> NDArray[np.float64]:
    """Integral over the sphere per channel, (3,), of a picture (rows, columns, 3)."""
    return (solid_angles(*image.shape[:2])[..., None] * image).sum(axis=(0, 1))


def great_circle(first: NDArray[np.float64], second: NDArray[np.float64], time: float) -> NDArray[np.float64]:
    """Return the unit vector, (3,), on the great circle between two others at a time from 0 to 1.

    Between opposite vectors the path passes the highest point.
    """
    angle = 2.0 * np.arctan2(np.linalg.norm(first - second), np.linalg.norm(first + second))
    if angle < 1e-9:
        return first
    if angle > np.pi - 1e-6:
        above = np.array([0.0, 0.0, 1.0]) if abs(first[2]) < 0.9 else np.array([1.0, 0.0, 0.0])
        across = above - (above @ first) * first
        across /= np.linalg.norm(across)
        return np.cos(time * np.pi) * first + np.sin(time * np.pi) * across
    return (np.sin((1.0 - time) * angle) * first + np.sin(time * angle) * second) / np.sin(angle)


def add_disc(image: NDArray[np.float64], center: NDArray[np.float64], flux: NDArray[np.float64], radius: float) -> None:
    """Add a uniform, antialiased disc whose total light is exact.

    Parameters
    ----------
    image : (rows, columns, 3) float64
        Modified in place.
    center : (3,) float64
        Unit vector to the center.
    flux : (3,) float64
        Integral over the sphere per channel.
    radius : float
        Angular radius in radians.
    """
    height, width = image.shape[:2]
    theta = np.arccos(np.clip(center[2], -1.0, 1.0))
    reach = radius + 2.0 * np.pi / height
    rows = np.arange(
        max(int((theta - reach) * height / np.pi), 0), min(int((theta + reach) * height / np.pi) + 2, height)
    )
    angles = ((rows[:, None] + (np.arange(_POINTS) + 0.5) / _POINTS) * (np.pi / height)).ravel()[:, None]
    turns = (np.arange(width * _POINTS) + 0.5) * (2.0 * np.pi / (width * _POINTS))
    azimuth = np.arctan2(center[1], center[0])
    haversine = np.sin((angles - theta) / 2) ** 2 + np.sin(angles) * np.sin(theta) * np.sin((turns - azimuth) / 2) ** 2
    inside = (haversine < np.sin(radius / 2) ** 2).reshape(len(rows), _POINTS, width, _POINTS).mean(axis=(1, 3))
    areas = solid_angles(height, width)[rows]
    if not inside.any():
        # A disc smaller than the spacing of the test points lights one pixel.
        column = int(azimuth % (2 * np.pi) * width / (2 * np.pi)) % width
        inside[int(np.argmin(np.abs((rows + 0.5) * (np.pi / height) - theta))), column] = 1.0
    image[rows] += (inside / (inside * areas).sum())[..., None] * flux
