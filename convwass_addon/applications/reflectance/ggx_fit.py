# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Fit a GGX material to a table, as a substitute for a Principled or Glossy BSDF."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.arrays.weighted_quantile import weighted_quantile
from .lobe_table import IncomingDirections, LobeTable, reflected_light
from .materials import Ggx

# Rows of the lobes that the fit compares, and the steepest incoming direction: beyond it, little light arrives.
_ROWS = 32
_STEEPEST = np.radians(70.0)
_MOST_DIRECTIONS = 6
_LEAST_ALPHA, _MOST_ALPHA = 5e-3, 1.0


@dataclass(frozen=True)
class GgxFit:
    """The best-fitting GGX material for a table, and the quality of the fit.

    Attributes
    ----------
    material : Ggx
        With the color that reproduces the mean reflected light.
    total_variation : float
        Fraction of the light that goes elsewhere, averaged over incoming directions: 0 for equal lobes, 1 for disjoint
        ones.
    peak_ratio : float
        Ratio of its peak to that of the table, for the first incoming direction.
    """

    material: Ggx
    total_variation: float
    peak_ratio: float

    def record(self) -> dict[str, object]:
        """Return the figures, ready for JSON."""
        material = self.material
        return {
            "alpha_x": material.alpha_x,
            "alpha_y": material.alpha_y,
            "roughness": material.roughness,
            "anisotropic": material.anisotropic,
            "rotation": material.rotation,
            "color": list(material.color),
            "total_variation": self.total_variation,
            "peak_ratio": self.peak_ratio,
        }


def fit_ggx(table: LobeTable) -> GgxFit:
    """Fit one GGX material to all lobes of a table by minimizing the total variation.

    Parameters
    ----------
    table : LobeTable
        The table. If it is isotropic, the fit is as well.

    Returns
    -------
    GgxFit
        Accurate for single highlights; it cannot represent a cross or two lobes of different widths.
    """
    # Imported here: SciPy loads a hundred modules for it, which most sessions do not need.
    from scipy.optimize import minimize, minimize_scalar

    chosen = np.flatnonzero(table.theta_in <= _STEEPEST)
    chosen = chosen[np.unique(np.linspace(0, len(chosen) - 1, _MOST_DIRECTIONS).astype(int))]
    incoming = IncomingDirections(table.theta_in[chosen], table.phi_in[chosen])
    aim = _coarsened((table.lobes * table.cells)[chosen])
    rows = aim.shape[1]

    def error(alphas: NDArray[np.float64]) -> float:
        return float(0.5 * np.abs(_shares(Ggx(*_bounded(alphas)), incoming, rows) - aim).sum(axis=(1, 2)).mean())

    start = np.log(_typical_slope(table))
    if table.is_isotropic:
        bracket = (max(start - 2.0, np.log(_LEAST_ALPHA)), min(start + 2.0, np.log(_MOST_ALPHA)))
        found = minimize_scalar(
            lambda x: error(np.array([x, x])), bounds=bracket, method="bounded", options={"xatol": 0.003}
        )
        best, left = np.array([found.x, found.x]), float(found.fun)
    else:
        simplex = np.array([[start, start], [start + 0.7, start - 0.7], [start - 0.7, start + 0.7]])
        options = {"initial_simplex": simplex, "xatol": 0.004, "fatol": 1e-4, "maxiter": 120}
        found = minimize(error, simplex[0], method="Nelder-Mead", options=options)
        best, left = found.x, float(found.fun)
    alphas = _bounded(best)
    return _colored(table, alphas, chosen, incoming, aim, left)


def _colored(
    table: LobeTable,
    alphas: list[float],
    chosen: NDArray[np.int64],
    incoming: IncomingDirections,
    aim: NDArray[np.float64],
    left: float,
) -> GgxFit:
    light = np.array(list(reflected_light(Ggx(*alphas), incoming, aim.shape[1])))[..., 0]
    albedo = light.sum(axis=(1, 2))
    color = np.clip(table.albedo[chosen].sum(axis=0) / albedo.sum(), 0.0, 1.0)
    first = light[0] / albedo[0]
    material = Ggx(*alphas, tuple(float(part) for part in color))
    return GgxFit(material, left, float((first / _sizes(aim)).max() / (aim[0] / _sizes(aim)).max()))


def _sizes(aim: NDArray[np.float64]) -> NDArray[np.float64]:
    """Relative solid angles of the rows of a coarse lobe, (rows, 1)."""
    return np.sin((np.arange(aim.shape[1]) + 0.5) * (np.pi / 2 / aim.shape[1]))[:, None]


def _bounded(logs: NDArray[np.float64]) -> list[float]:
    return [float(alpha) for alpha in np.clip(np.exp(logs), _LEAST_ALPHA, _MOST_ALPHA)]


def _shares(material: Ggx, incoming: IncomingDirections, rows: int) -> NDArray[np.float64]:
    """Fraction of the light that goes out to every cell, (n, rows, columns); sum 1."""
    light = np.array([own[..., 0] for own in reflected_light(material, incoming, rows)])
    return light / light.sum(axis=(1, 2), keepdims=True)


def _coarsened(shares: NDArray[np.float64]) -> NDArray[np.float64]:
    """Sum blocks of cells until there are few enough rows."""
    while shares.shape[1] > _ROWS and shares.shape[1] % 2 == 0:
        count, rows, columns = shares.shape
        shares = shares.reshape(count, rows // 2, 2, columns // 2, 2).sum(axis=(2, 4))
    return shares


def _typical_slope(table: LobeTable) -> float:
    """Median slope of the facets at the first incoming direction; for an isotropic GGX material this is its alpha."""
    half = table.outgoing + table.incoming[0]
    slope = (np.hypot(half[..., 0], half[..., 1]) / half[..., 2]).ravel()
    mass = (table.lobes[0] * table.cells).ravel()
    return float(np.clip(weighted_quantile(slope, mass, 0.5), 2 * _LEAST_ALPHA, _MOST_ALPHA))
