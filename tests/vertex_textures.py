# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Read textures of vertices as shaders do."""

from __future__ import annotations


def gathered(grid, image):
    """The values of vertices, (frames, n, c), from an image that `grid.arranged` made."""
    return image.reshape(grid.frames, grid.rows * grid.width, -1)[:, : grid.points]


def joined_steps(split, bounds):
    """The positions, (f, n, 3), from the bytes of `split_steps`."""
    steps = 256.0 * split[0] + split[1]
    return bounds[0] + steps / 65535 * (bounds[1] - bounds[0])


def unpacked_normals(packed):
    """The vectors, (f, n, 3), from the bytes of `packed_normals`, not normalized."""
    return packed / 127.5 - 1.0
