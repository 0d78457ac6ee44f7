# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured materials in the format of the MERL database (Matusik et al. 2003)."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from .materials import half_vectors

_HALF, _DIFFERENCE, _AZIMUTH = 90, 90, 180
_VALUES = _HALF * _DIFFERENCE * _AZIMUTH
_HEADER = struct.Struct("<3i")
_BYTES = _HEADER.size + 3 * 8 * _VALUES
# Scaling factors of the channels.
_SCALES = np.array([1.0, 1.15, 1.66]) / 1500.0
# Upper limit of plausible values.
_LARGEST = 1e9


@dataclass(frozen=True)
class MerlMaterial:
    """A measured isotropic material.

    Attributes
    ----------
    values : (90, 90, 180, 3) float32
        f in 1/sr by half angle (evenly spaced in its square root), difference angle and the azimuth of the latter;
        unmeasured values are 0.
    """

    values: NDArray[np.float32]
    is_isotropic = True

    def reflectance(self, incoming: NDArray[np.float64], outgoing: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the measured value nearest to each pair of directions, (..., 3)."""
        half = half_vectors(incoming, outgoing)
        aslant = np.hypot(half[..., 0], half[..., 1])
        theta_h = np.arctan2(aslant, half[..., 2])
        # Axes of the half vector: y perpendicular to it and x pointing up along it; arbitrary if it points straight up.
        straight = aslant < 1e-12
        along = np.where(straight, 1.0, half[..., 0] / np.where(straight, 1.0, aslant))
        across = np.where(straight, 0.0, half[..., 1] / np.where(straight, 1.0, aslant))
        x = incoming[0] * along + incoming[1] * across
        y = incoming[1] * along - incoming[0] * across
        tilted = x * half[..., 2] - incoming[2] * aslant
        theta_d = np.arccos(np.clip((half * incoming).sum(axis=-1), -1.0, 1.0))
        phi_d = np.arctan2(y, tilted) % np.pi
        row = np.sqrt(theta_h * (2.0 / np.pi)) * _HALF
        places = (
            (row, _HALF),
            (theta_d * (2.0 / np.pi) * _DIFFERENCE, _DIFFERENCE),
            (phi_d / np.pi * _AZIMUTH, _AZIMUTH),
        )
        index = tuple(np.clip(place.astype(int), 0, count - 1) for place, count in places)
        return self.values[index].astype(np.float64)


def read_merl(path: Path) -> MerlMaterial:
    """Read a file of the MERL database.

    Raises
    ------
    InputError
        The file does not exist, has the wrong size, or implausible values.
    """
    try:
        size = path.stat().st_size
        if size != _BYTES:
            raise InputError("{name} is not a material of the MERL database: its size is wrong.", name=path.name)
        with path.open("rb") as file:
            dimensions = _HEADER.unpack(file.read(_HEADER.size))
            if dimensions != (_HALF, _DIFFERENCE, _AZIMUTH):
                raise InputError("{name} is not a material of the MERL database: its header is wrong.", name=path.name)
            content = file.read(_BYTES - _HEADER.size)
    except OSError as problem:
        raise InputError("{name} cannot be read: {problem}", name=path.name, problem=problem.strerror) from problem
    if len(content) != _BYTES - _HEADER.size:
        raise InputError("{name} is not a material of the MERL database: its size is wrong.", name=path.name)
    values = np.frombuffer(content, "<f8").reshape(3, _HALF, _DIFFERENCE, _AZIMUTH)
    if not np.isfinite(values).all() or np.abs(values).max() > _LARGEST:
        raise InputError("{name} has values that are impossible for a material.", name=path.name)
    scaled = np.maximum(np.moveaxis(values, 0, -1) * _SCALES, 0.0).astype(np.float32)
    if not scaled.any():
        raise InputError("{name} has values that are impossible for a material.", name=path.name)
    return MerlMaterial(scaled)
