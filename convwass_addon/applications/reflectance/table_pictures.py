# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Complete tables of lobes as images: f for every pair of directions, below a header with the incoming directions."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...transport.sphere import directions, solid_angles
from .lobe_table import LobeTable
from .table_files import MOST_DIRECTIONS, MOST_ROWS, checked_table

# Upper limit of plausible values.
_LARGEST = 1e9


def table_picture(table: LobeTable) -> NDArray[np.float32]:
    """Return f of a table as an image.

    Parameters
    ----------
    table : LobeTable
        With `rows` rows and four times as many columns.

    Returns
    -------
    (head + n * rows, 4 * rows, 3) float32
        The first rows are a header with one pixel per incoming direction: its angle from the normal and its azimuth,
        both in radians, and 1; the rest of the header is 0. Below it follows f in 1/sr, one hemisphere after the other:
        row i has the angle (i + 1/2) 90 degrees / rows from the normal, column j the azimuth (j + 1/2) 360 degrees /
        columns.
    """
    count, rows, columns = table.lobes.shape
    head = np.zeros((_head_rows(count, columns) * columns, 3), dtype=np.float32)
    head[:count] = np.stack([table.theta_in, table.phi_in, np.ones(count)], axis=1)
    light = table.reflectance().reshape(count * rows, columns, 3)
    return np.concatenate([head.reshape(-1, columns, 3), light]).astype(np.float32)


def has_table_size(width: int, height: int) -> bool:
    """Return whether an image of this size can be a table."""
    return _directions_of(width, height) is not None


def table_of_picture(picture: NDArray[np.float32], name: str) -> LobeTable:
    """Read an image written by :func:`table_picture`.

    Parameters
    ----------
    picture : (height, width, 3) float
        Top row first.
    name : str
        Name of the file for messages.

    Raises
    ------
    InputError
        Not such an image, or invalid values.
    """
    height, width = picture.shape[:2]
    count = _directions_of(width, height)
    if count is None:
        raise InputError("{name} is not a table of lobes.", name=name)
    # Check before casting, which warns about some NaNs.
    if not np.isfinite(picture).all():
        raise InputError("{name} has values that are invalid for a table of lobes.", name=name)
    values = picture.astype(np.float64)
    if values.min() < 0 or values.max() > _LARGEST:
        raise InputError("{name} has values that are invalid for a table of lobes.", name=name)
    rows, head_rows = width // 4, _head_rows(count, width)
    head = values[:head_rows].reshape(-1, 3)
    if (head[:count, 2] != 1).any() or head[count:].any():
        raise InputError("{name} is not a table of lobes.", name=name)
    light = values[head_rows:].reshape(count, rows, width, 3) * directions(2 * rows, width)[:rows, :, 2:]
    cells = solid_angles(2 * rows, width)[:rows]
    albedo = (light * cells[..., None]).sum(axis=(1, 2))
    grey = light.sum(axis=3)
    mass = (grey * cells).sum(axis=(1, 2))[:, None, None]
    # A direction that reflects nothing gets the lobe of a diffuse material.
    matte = directions(2 * rows, width)[:rows, :, 2]
    lobes = np.where(mass > 0, grey / np.where(mass > 0, mass, 1.0), matte / (matte * cells).sum())
    return checked_table(head[:count, 0], head[:count, 1], lobes, albedo, name)


def _directions_of(width: int, height: int) -> int | None:
    """Return the number of incoming directions of a table image of this size; None if it cannot be a table."""
    rows = width // 4
    if width % 8 or not 8 <= width <= 4 * MOST_ROWS:
        return None
    count = height // rows
    while count > 1 and count * rows + _head_rows(count, width) > height:
        count -= 1
    fits = 2 <= count <= MOST_DIRECTIONS and count * rows + _head_rows(count, width) == height
    return count if fits else None


def _head_rows(count: int, columns: int) -> int:
    return -(-count // columns)
