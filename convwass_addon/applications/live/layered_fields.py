# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Lattices of level fields in layers, each of which covers the older ones as it is filled.

The oldest layer covers the field of a single blend, the one that was pointed at last. One thread adds layers and
fields while another one asks what a blend is mixed from.
"""

from __future__ import annotations

import threading
from collections.abc import Sequence
from dataclasses import dataclass

from .filling_lattice import FillingLattice, Mixture
from .level_fields import LevelField

LEAST_REST = 1e-3
"""Below this share, what the layers do not cover of a blend is left out."""


@dataclass(frozen=True)
class HandField:
    """The field of the blend that was pointed at last.

    Attributes
    ----------
    weights : tuple of float
        Weights of the blend, (k,).
    field : LevelField
        Its field.
    """

    weights: tuple[float, ...]
    field: LevelField


class LayeredFields:
    """Layers of lattices over the field of a single blend.

    Attributes
    ----------
    hand : HandField or None
        The field of the single blend.
    """

    def __init__(self) -> None:
        self.hand: HandField | None = None
        self._lock = threading.Lock()
        # The newest first.
        self._layers: list[FillingLattice] = []

    @property
    def newest(self) -> FillingLattice | None:
        """The layer that covers the others; None before the first one."""
        return self._layers[0] if self._layers else None

    @property
    def oldest(self) -> FillingLattice | None:
        """The layer below the others; None before the first one."""
        return self._layers[-1] if self._layers else None

    @property
    def bytes(self) -> int:
        """Memory that the fields of the layers take."""
        return sum(layer.bytes for layer in self._layers)

    @property
    def filled(self) -> int:
        """Number of fields in the layers."""
        return sum(layer.filled for layer in self._layers)

    def set_hand(self, weights: tuple[float, ...], field: LevelField) -> None:
        """Replace the field of the single blend."""
        with self._lock:
            self.hand = HandField(weights, field)

    def cover(self, layer: FillingLattice) -> None:
        """Add a layer above the others."""
        with self._lock:
            self._layers = [layer, *self._layers]

    def mixture(self, weights: Sequence[float], now: float) -> Mixture:
        """Return what a blend is mixed from at a time in seconds: each layer takes its share of what newer ones leave.

        The field of the single blend, whatever its weights are, takes what is left of all layers.
        """
        with self._lock:
            found = self._covered(weights, now)
            if found.rest < LEAST_REST or self.hand is None:
                return found
            return Mixture((*found.fields, self.hand.field), (*found.shares, found.rest), 0.0)

    def coverage(self, weights: Sequence[float], now: float) -> float:
        """Return the share of a blend that comes from the layers, 0 to 1."""
        with self._lock:
            return 1.0 - self._covered(weights, now).rest

    def _covered(self, weights: Sequence[float], now: float) -> Mixture:
        """Return what a blend is mixed from, of the layers only."""
        fields: list[LevelField] = []
        shares: list[float] = []
        rest = 1.0
        for layer in self._layers:
            found = layer.mixture(weights, now)
            fields += found.fields
            shares += [rest * share for share in found.shares]
            rest *= found.rest
            if rest < LEAST_REST:
                break
        return Mixture(tuple(fields), tuple(shares), rest)

    def settle(self, now: float) -> None:
        """Drop layers that a newer one has taken over from."""
        with self._lock:
            if len(self._layers) > 1 and self._layers[0].has_taken_over(now):
                self._layers = self._layers[:1]
