# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Densities on a surface at several times, with what is known about how each was solved."""

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
        When; numbers of places, for a graph.
    densities : (f, n) float64
        Mass 1 each, under ``surface.weights``.
    records : list of dict
        For every frame, ready for JSON: its `time`, the `key` it is (the name of the density that was given, or None),
        its `entropy` in nats, and of its solve `marginal_error`, `converged`, `iterations`, `numerics`, and
        `raised_limit`, the nats by which its bound had to be raised to get there.
    surface : Surface
        Where they are.
    """

    times: NDArray[np.float64]
    densities: NDArray[np.float64]
    records: list[dict[str, object]]
    surface: Surface

    __repr__ = one_line("times", "densities")

    @property
    def covered(self) -> NDArray[np.float64]:
        """What has been covered so far, (f, n): every frame as a share of its own largest value, and never less.

        What a growth that creeps along leaves behind stays covered.
        """
        tops = self.densities.max(axis=1, keepdims=True)
        return np.maximum.accumulate(self.densities / tops, axis=0)

    def from_frame(self, first: int) -> DensityFrames:
        """Return the frames from number `first` on."""
        return DensityFrames(self.times[first:], self.densities[first:], self.records[first:], self.surface)


def joined_frames(parts: Sequence[DensityFrames]) -> DensityFrames:
    """Return the frames of several parts on one surface, in their order."""
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
    """Return the figures of a frame, ready for JSON."""
    return {
        "time": float(time),
        "key": key,
        "entropy": float(entropy),
        # An error that was never measured is no number of JSON's.
        "marginal_error": float(marginal_error) if np.isfinite(marginal_error) else None,
        "converged": bool(converged),
        "iterations": int(iterations),
        "numerics": numerics,
        "raised_limit": float(raised),
    }


def comparable(
    weights: Sequence[ArrayLike], names: Sequence[str], surface: Surface, settings: DensitySettings
) -> NDArray[np.float64]:
    """Return painted weights as densities, (k, n), between which mass can travel.

    Raises
    ------
    InputError
        Fewer than two, another number of names, weights that are no distributions, or that lie on different pieces.
    """
    if len(weights) != len(names):
        raise InputError("There are {groups} groups and {names} names.", groups=len(weights), names=len(names))
    if len(weights) < 2:
        raise InputError("There must be at least two groups; choose one more.")
    densities = np.stack([distribution(w, surface, name) for w, name in zip(weights, names, strict=True)])
    return on_same_pieces(densities, names, surface, settings.pieces == "match")
