# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Vertex animation textures: images from which a vertex shader reads the positions of vertices in every frame.

Each texel holds one vertex in one frame. A frame takes a whole number of rows; frames follow each other from the top.
The position of a vertex in frame k is at (u, v + k / frames), where (u, v) are its texture coordinates, with the origin
at the top left as in glTF.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError

LARGEST_TEXTURE = 8192
"""Largest width and height that WebGL 2 and mobile engines support on common graphics cards."""

_LEAST_WIDTH = 64
_STEPS = 65535


@dataclass(frozen=True)
class TextureGrid:
    """The texels of all vertices in all frames.

    Attributes
    ----------
    points, frames : int
        Number of vertices and of frames.
    width : int
        Texels per row, a power of two.
    """

    points: int
    frames: int
    width: int

    @classmethod
    def of(cls, points: int, frames: int) -> TextureGrid:
        """Choose a width for roughly square images; an image of twice the height must not exceed `LARGEST_TEXTURE`.

        Raises
        ------
        InputError
            There are too many values for one image.
        """
        width = _LEAST_WIDTH
        while width < LARGEST_TEXTURE and 2 * frames * -(-points // width) > width:
            width *= 2
        grid = cls(points, frames, width)
        if 2 * grid.height > LARGEST_TEXTURE:
            raise InputError(
                "{points} vertices in {frames} frames do not fit a texture of {most} pixels a side; export fewer "
                "frames, or a coarser mesh.",
                points=points,
                frames=frames,
                most=LARGEST_TEXTURE,
            )
        return grid

    @property
    def rows(self) -> int:
        """Rows per frame."""
        return -(-self.points // self.width)

    @property
    def height(self) -> int:
        """Rows of all frames."""
        return self.frames * self.rows

    def coordinates(self) -> NDArray[np.float64]:
        """Return the texture coordinates of every vertex in the first frame, (n, 2): centers of texels."""
        rows, columns = np.divmod(np.arange(self.points), self.width)
        return np.stack([(columns + 0.5) / self.width, (rows + 0.5) / self.height], axis=1)

    def arranged(self, values: NDArray[np.generic]) -> NDArray[np.generic]:
        """Return values of vertices, (frames, n, c), as an image, (height, width, c), top row first."""
        channels = values.shape[2]
        image = np.zeros((self.frames, self.rows * self.width, channels), dtype=values.dtype)
        image[:, : self.points] = values
        return image.reshape(self.height, self.width, channels)


@dataclass(frozen=True)
class VertexAnimation:
    """The motion of a mesh's vertices.

    Attributes
    ----------
    points : (f, n, 3) float64
        Positions in every frame.
    normals : (f, n, 3) float64
        Unit normals.
    colors : (f, n, 3) float64 or None
        sRGB from 0 to 1.
    changing : bool
        Whether topology changes from frame to frame: vertices are then corners of triangles, three for each, which do
        not correspond between frames, and surplus triangles have no area.
    """

    points: NDArray[np.float64]
    normals: NDArray[np.float64]
    colors: NDArray[np.float64] | None = None
    changing: bool = False

    @property
    def grid(self) -> TextureGrid:
        """Return the layout of the textures; raises InputError if they would be too large."""
        return TextureGrid.of(self.points.shape[1], self.points.shape[0])

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Minimum and maximum coordinates over all frames, (2, 3)."""
        return np.stack([self.points.min(axis=(0, 1)), self.points.max(axis=(0, 1))])


def padded_triangles(
    corners: Sequence[NDArray[np.float64]],
    normals: Sequence[NDArray[np.float64]],
    colors: Sequence[NDArray[np.float64]] | None = None,
) -> VertexAnimation:
    """Pad all frames of changing topology to the number of triangles of the largest.

    Parameters
    ----------
    corners, normals : sequence of (m, 3, 3) float64
        Positions and unit normals at the corners of the triangles of every frame.
    colors : sequence of (m, 3, 3) float64, optional
        sRGB at these corners.
    """
    most = max(len(own) for own in corners)

    def padded(frames: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
        # All surplus corners coincide with one point of the surface, so that the bounds stay the same.
        rows = [np.concatenate([own, np.broadcast_to(own[:1, :1], (most - len(own), 3, 3))]) for own in frames]
        return np.stack(rows).reshape(len(frames), 3 * most, 3)

    return VertexAnimation(padded(corners), padded(normals), None if colors is None else padded(colors), changing=True)


def split_steps(points: NDArray[np.float64], bounds: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Quantize positions to 16 bits per axis, and split them into high and low bytes.

    Parameters
    ----------
    points : (f, n, 3) float64
        Within the bounds.
    bounds : (2, 3) float64
        Coordinates represented by 0 and 65535.

    Returns
    -------
    (2, f, n, 3) uint8
        High bytes, then low bytes. Many importers, including browsers, reduce 16-bit images to 8 bits.
    """
    extent = np.where(bounds[1] > bounds[0], bounds[1] - bounds[0], 1.0)
    steps = np.clip(np.rint((points - bounds[0]) / extent * _STEPS), 0, _STEPS).astype(np.uint16)
    return np.stack([steps >> 8, steps & 255]).astype(np.uint8)


def packed_normals(normals: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Quantize unit vectors, (f, n, 3), to 8 bits per axis: 0 stands for -1 and 255 for 1."""
    return np.clip(np.rint((normals * 0.5 + 0.5) * 255.0), 0, 255).astype(np.uint8)


def y_up(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Convert points or vectors, (..., 3), to the axes of glTF: Blender's Z becomes Y, and its Y becomes -Z."""
    return np.stack([vectors[..., 0], vectors[..., 2], -vectors[..., 1]], axis=-1)
