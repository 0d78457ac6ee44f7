# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Densities on a surface at several times, with records of how they were solved."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError
from ...one_line import one_line
from ...transport import Surface
from .density_pieces import on_same_pieces
from .density_settings import DensitySettings
from .surface_densities import distribution


@dataclass(frozen=True)
class DensityFrames:
    """Densities on a surface at several times.

    Attributes
    ----------
    times : (f,) float64
        Times of the frames; for a graph, indices of its nodes.
    densities : (f, n) float64
        Mass 1 each, under ``surface.weights``.
    records : list of dict
        One JSON-ready record per frame: its `time`, its `key` (the name of the given density, or None for solved
        frames), its `entropy` in nats, the solver's `marginal_error`, `converged`, `iterations` and `numerics`, and
        `raised_limit`, the nats by which its entropy bound had to be raised.
    surface : Surface
        The surface of the densities.
    """

    times: NDArray[np.float64]
    densities: NDArray[np.float64]
    records: list[dict[str, object]]
    surface: Surface

    __repr__ = one_line("times", "densities")

    @property
    def covered(self) -> NDArray[np.float64]:
        """Running maximum of the frames, (f, n), each normalized to a maximum of 1.

        For growth: what was covered once stays covered.
        """
        tops = self.densities.max(axis=1, keepdims=True)
        return np.maximum.accumulate(self.densities / tops, axis=0)

    def without_first(self) -> DensityFrames:
        """Return the frames after the first."""
        return DensityFrames(self.times[1:], self.densities[1:], self.records[1:], self.surface)


def joined_frames(parts: Sequence[DensityFrames]) -> DensityFrames:
    """Concatenate frames on one surface."""
    return DensityFrames(
        np.concatenate([part.times for part in parts]),
        np.concatenate([part.densities for part in parts]),
        [record for part in parts for record in part.records],
        parts[0].surface,
    )


def record(
    time: float,
    entropy: float,
    key: str | None = None,
    marginal_error: float = 0.0,
    converged: bool = True,
    iterations: int = 0,
    numerics: str = "scaling",
    raised: float = 0.0,
) -> dict[str, object]:
    """Return the JSON-ready record of a frame."""
    return {
        "time": float(time),
        "key": key,
        "entropy": float(entropy),
        # An error is infinite if it was never measured; JSON has no infinity.
        "marginal_error": float(marginal_error) if np.isfinite(marginal_error) else None,
        "converged": bool(converged),
        "iterations": int(iterations),
        "numerics": numerics,
        "raised_limit": float(raised),
    }


def require_reachable_limit(surface: Surface, settings: DensitySettings) -> None:
    """Refuse an entropy limit that no density on a surface meets; raises InputError.

    The density of the least entropy is a unit mass at the vertex with the smallest area.
    """
    limit = settings.entropy_limit
    if limit is None or isinstance(limit, str):
        return
    # Loose vertices have no area, and no mass.
    least = float(np.log(surface.weights[surface.weights > 0.0].min()))
    if limit < least:
        raise InputError(
            "No density on this mesh has an entropy as low as {limit:g}: a single vertex has {least:.2f}. Raise the "
            "entropy limit.",
            limit=limit,
            least=least,
        )


def comparable(
    weights: Sequence[ArrayLike], names: Sequence[str], surface: Surface, settings: DensitySettings
) -> NDArray[np.float64]:
    """Return painted weights as densities, (k, n), with equal masses on every connected component.

    Raises
    ------
    InputError
        Fewer than two densities, the wrong number of names, invalid weights, different components, or an entropy limit
        that no density meets.
    """
    require_reachable_limit(surface, settings)
    if len(weights) != len(names):
        raise InputError("There are {groups} groups and {names} names.", groups=len(weights), names=len(names))
    if len(weights) < 2:
        raise InputError("There must be at least two groups; choose one more.")
    densities = np.stack([distribution(w, surface, name) for w, name in zip(weights, names, strict=True)])
    return on_same_pieces(densities, names, surface, settings.pieces == "match")
