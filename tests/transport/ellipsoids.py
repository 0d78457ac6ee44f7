# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Uniform ellipsoids, whose Wasserstein barycenters are uniform ellipsoids in closed form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import sqrtm
from scipy.spatial.transform import Rotation


@dataclass(frozen=True)
class Ellipsoid:
    """The image of the unit ball under the symmetric matrix `stretch`, translated to `center`; in cells."""

    center: np.ndarray
    stretch: np.ndarray

    @classmethod
    def rotated(cls, center, radii, angles) -> Ellipsoid:
        turn = Rotation.from_euler("xyz", angles).as_matrix()
        return cls(np.asarray(center, float), turn @ np.diag(radii) @ turn.T)

    @property
    def volume(self) -> float:
        return 4 / 3 * np.pi * float(np.linalg.det(self.stretch))

    def occupancy(self, cells: int, samples: int = 4) -> np.ndarray:
        """Filled fraction of every cell, by subsampling."""
        inverse = np.linalg.inv(self.stretch)
        axis = (np.arange(cells * samples) + 0.5) / samples
        inside = np.zeros((cells,) * 3)
        for i in range(cells):
            x = axis[i * samples : (i + 1) * samples]
            points = np.stack(np.meshgrid(x, axis, axis, indexing="ij"), axis=-1) - self.center
            hit = (np.einsum("...i,ji->...j", points, inverse) ** 2).sum(-1) <= 1
            inside[i] = hit.reshape(samples, cells, samples, cells, samples).mean(axis=(0, 2, 4))
        return inside

    def barycenter(self, other: Ellipsoid, t: float) -> Ellipsoid:
        """The displacement interpolation at t.

        The optimal map between the centered ellipsoids with covariances S0 and S1 is linear,
        T = S0^(-1/2) (S0^(1/2) S1 S0^(1/2))^(1/2) S0^(-1/2), and the interpolation is the image of the first under
        (1 - t) I + t T.
        """
        root = self.stretch
        inverse = np.linalg.inv(root)
        middle = np.real(sqrtm(root @ other.stretch @ other.stretch @ root))
        map_ = (1 - t) * np.eye(3) + t * inverse @ middle @ inverse
        covariance = map_ @ self.stretch @ self.stretch @ map_.T
        return Ellipsoid((1 - t) * self.center + t * other.center, np.real(sqrtm(covariance)))


def intersection_over_union(one: np.ndarray, other: np.ndarray) -> float:
    """Intersection over union of two occupancies with values in [0, 1]."""
    return float(np.minimum(one, other).sum() / np.maximum(one, other).sum())
