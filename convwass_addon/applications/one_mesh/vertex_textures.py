# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Vertex animation textures: images from which a vertex shader reads where vertices are in every frame.

Each texel holds one vertex in one frame. A frame takes as many whole rows as it needs; frames follow each other from
the top. The position of a vertex in frame k is at (u, v + k / frames), where (u, v) are its texture coordinates, with
the origin at the top left as in glTF.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError

LARGEST_TEXTURE = 8192
"""Most texels along a side: what graphics cards for WebGL 2 and mobile engines take."""

_LEAST_WIDTH = 64
_STEPS = 65535


@dataclass(frozen=True)
class TextureGrid:
    """Which texel belongs to which vertex in which frame.

    Attributes
    ----------
    points, frames : int
        How many vertices and frames there are.
    width : int
        Texels of a row, a power of two.
    """

    points: int
    frames: int
    width: int

    @classmethod
    def of(cls, points: int, frames: int) -> TextureGrid:
        """Choose a width for about square images, of which one of twice the height must fit `LARGEST_TEXTURE`.

        Raises
        ------
        InputError
            There is too much for one image.
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
        """Rows of a frame."""
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

    def gathered(self, image: NDArray[np.generic]) -> NDArray[np.generic]:
        """Return the values, (frames, n, c), of an image that `arranged` made."""
        return image.reshape(self.frames, self.rows * self.width, -1)[:, : self.points]


@dataclass(frozen=True)
class VertexAnimation:
    """How the vertices of a mesh move.

    Attributes
    ----------
    points : (f, n, 3) float64
        Positions in every frame.
    normals : (f, n, 3) float64
        Unit normals.
    colors : (f, n, 3) float64 or None
        sRGB from 0 to 1.
    changing : bool
        The vertices of a frame are corners of triangles, three for each, which have nothing to do with those of the
        next frame; surplus triangles have no area. Otherwise vertices keep their meaning.
    """

    points: NDArray[np.float64]
    normals: NDArray[np.float64]
    colors: NDArray[np.float64] | None = None
    changing: bool = False

    @property
    def grid(self) -> TextureGrid:
        """Return where the vertices are in the textures; raises InputError where they do not fit."""
        return TextureGrid.of(self.points.shape[1], self.points.shape[0])

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Lowest and highest coordinates of all frames, (2, 3)."""
        return np.stack([self.points.min(axis=(0, 1)), self.points.max(axis=(0, 1))])


def padded_triangles(
    corners: Sequence[NDArray[np.float64]],
    normals: Sequence[NDArray[np.float64]],
    colors: Sequence[NDArray[np.float64]] | None = None,
) -> VertexAnimation:
    """Give all frames of changing topology as many triangles as the largest has.

    Parameters
    ----------
    corners, normals : sequence of (m, 3, 3) float64
        Positions and unit normals at the corners of the triangles of every frame.
    colors : sequence of (m, 3, 3) float64, optional
        sRGB there.
    """
    most = max(len(own) for own in corners)

    def padded(frames: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
        # All surplus corners are one point of the surface, which leaves the bounds as they are.
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
        What 0 and 65535 stand for.

    Returns
    -------
    (2, f, n, 3) uint8
        High bytes, then low bytes. Many importers, browsers among them, reduce images of 16 bits to 8.
    """
    extent = np.where(bounds[1] > bounds[0], bounds[1] - bounds[0], 1.0)
    steps = np.clip(np.rint((points - bounds[0]) / extent * _STEPS), 0, _STEPS).astype(np.uint16)
    return np.stack([steps >> 8, steps & 255]).astype(np.uint8)


def joined_steps(split: NDArray[np.uint8], bounds: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the positions, (f, n, 3), that `split_steps` has quantized: what a shader does."""
    steps = 256.0 * split[0] + split[1]
    return bounds[0] + steps / _STEPS * (bounds[1] - bounds[0])


def packed_normals(normals: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Quantize unit vectors, (f, n, 3), to 8 bits per axis: -1 is 0 and 1 is 255."""
    return np.clip(np.rint((normals * 0.5 + 0.5) * 255.0), 0, 255).astype(np.uint8)


def unpacked_normals(packed: NDArray[np.uint8]) -> NDArray[np.float64]:
    """Return the vectors, (f, n, 3), that `packed_normals` has quantized, not normalized."""
    return packed / 127.5 - 1.0


def y_up(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points or vectors, (..., 3), in the axes of glTF: Blender's Z is Y there, and its Y is -Z."""
    return np.stack([vectors[..., 0], vectors[..., 2], -vectors[..., 1]], axis=-1)
