# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Interpolate a table between its directions such that highlights stay at the right half vector."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from .lobe_table import LobeTable
from .materials import half_vectors

WIDTH, HEIGHT = 256, 64
"""Size in texels of one table as an image: half angles along X, difference angles along Y."""

# Azimuths of the light around the half vector over which a texel is averaged; the other half is symmetric.
_AZIMUTHS = 16


def reflectance_at(
    table: LobeTable, incoming: NDArray[np.float64], outgoing: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Reflectance of an isotropic material between any two directions.

    Averaging the lobes of two tabulated incoming angles would double a narrow highlight. Instead, each lobe is read at
    the outgoing direction for which its half vector is the given one.

    Parameters
    ----------
    table : LobeTable
        Of an isotropic material.
    incoming, outgoing : (n, 3)
        Unit vectors; the normal is +Z.

    Returns
    -------
    (n, 3) float64
        f in 1/sr; 0 below the horizon.

    Raises
    ------
    InputError
        The material is anisotropic.
    """
    if not table.is_isotropic:
        raise InputError("An anisotropic material cannot be looked up by its half angles; export the table.")
    half = half_vectors(incoming, outgoing)
    azimuth = np.arctan2(half[:, 1], half[:, 0]) - np.arctan2(incoming[:, 1], incoming[:, 0])
    aslant = np.hypot(half[:, 0], half[:, 1])
    turned = np.stack([aslant * np.cos(azimuth), aslant * np.sin(azimuth), half[:, 2]], axis=-1)
    theta = np.arctan2(np.hypot(incoming[:, 0], incoming[:, 1]), incoming[:, 2])
    place = np.interp(theta, table.theta_in, np.arange(len(table.theta_in)))
    low = np.minimum(place.astype(int), len(table.theta_in) - 2)
    total, share = np.zeros((len(theta), 3)), np.zeros(len(theta))
    for index, part in ((low, 1.0 - (place - low)), (low + 1, place - low)):
        light = table.incoming[index]
        mirrored = 2.0 * (light * turned).sum(axis=-1, keepdims=True) * turned - light
        part = np.where(mirrored[:, 2] > 0, part, 0.0)
        total += part[:, None] * _read(table, index, mirrored)
        share += part
    visible = (incoming[:, 2] > 0) & (outgoing[:, 2] > 0) & (share > 0)
    return np.where(visible[:, None], total / np.where(share > 0, share, 1.0)[:, None], 0.0)


def _read(table: LobeTable, index: NDArray[np.int64], outgoing: NDArray[np.float64]) -> NDArray[np.float64]:
    """Interpolate lobes linearly between their cells, also across the pole; return f."""
    rows, columns = table.lobes.shape[1:]
    theta = np.arctan2(np.hypot(outgoing[:, 0], outgoing[:, 1]), outgoing[:, 2])
    row = theta * (2.0 * rows / np.pi) - 0.5
    column = np.arctan2(outgoing[:, 1], outgoing[:, 0]) * (columns / (2.0 * np.pi)) - 0.5
    first, left = np.floor(row).astype(int), np.floor(column).astype(int)
    result = np.zeros(len(index))
    for down, own in ((first, 1.0 - (row - first)), (first + 1, row - first)):
        # Beyond the pole is the cell half a turn away.
        over = np.where(down < 0, columns // 2, 0)
        line = np.minimum(np.maximum(down, -1 - down), rows - 1)
        for across, part in ((left, 1.0 - (column - left)), (left + 1, column - left)):
            values = table.lobes[index, line, (across + over) % columns] / table.outgoing[line, 0, 2]
            result += own * part * values
    return result[:, None] * table.albedo[index]


def half_angle_table(table: LobeTable) -> NDArray[np.float32]:
    """Tabulate a material by half and difference angle (Rusinkiewicz 1998), as an image for shaders.

    Parameters
    ----------
    table : LobeTable
        Of an isotropic material.

    Returns
    -------
    (HEIGHT, WIDTH, 3) float32
        f in 1/sr, averaged over the azimuth of the light around the half vector; where no such pair of directions lies
        above the surface, the last valid value of the row. Texel (i, j) has the difference angle 90 degrees v,
        v = (i + 1/2) / HEIGHT, and the half angle 90 degrees u^2, u = (j + 1/2) / WIDTH.

    Raises
    ------
    InputError
        The material is anisotropic.
    """
    theta_d = ((np.arange(HEIGHT) + 0.5) / HEIGHT * (np.pi / 2))[:, None, None]
    theta_h = (((np.arange(WIDTH) + 0.5) / WIDTH) ** 2 * (np.pi / 2))[None, :, None]
    phi_d = (np.arange(_AZIMUTHS) + 0.5) * (np.pi / _AZIMUTHS)
    theta_d, theta_h, phi_d = np.broadcast_arrays(theta_d, theta_h, phi_d)
    x, y, z = np.sin(theta_d) * np.cos(phi_d), np.sin(theta_d) * np.sin(phi_d), np.cos(theta_d)
    cosine, sine = np.cos(theta_h), np.sin(theta_h)
    incoming = np.stack([cosine * x + sine * z, y, cosine * z - sine * x], axis=-1).reshape(-1, 3)
    half = np.stack([sine, np.zeros_like(sine), cosine], axis=-1).reshape(-1, 3)
    outgoing = 2.0 * (incoming * half).sum(axis=-1, keepdims=True) * half - incoming
    above = (incoming[:, 2] > 0) & (outgoing[:, 2] > 0)
    values = np.zeros((len(above), 3))
    values[above] = reflectance_at(table, incoming[above], outgoing[above])
    counts = above.reshape(HEIGHT, WIDTH, _AZIMUTHS).sum(axis=2)
    means = values.reshape(HEIGHT, WIDTH, _AZIMUTHS, 3).sum(axis=2) / np.maximum(counts, 1)[..., None]
    last = np.maximum.accumulate(np.where(counts > 0, np.arange(WIDTH), 0), axis=1)
    return np.take_along_axis(means, last[..., None], axis=1).astype(np.float32)
