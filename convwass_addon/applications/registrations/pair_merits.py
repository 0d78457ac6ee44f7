# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Registered pairs of shapes, and which of two is better."""

from __future__ import annotations

from dataclasses import dataclass

from .pair_maps import PairMap
from .pair_registration import LaidPair

# Symmetric shapes seem to face opposite ways if their registrations keep left and right on less than the first share of
# the surface, or move matter farther than the second number of times the Wasserstein distance.
_LOPSIDED, _DETOUR = 0.5, 1.8
# What a map without a common mirror plane counts. A man maps onto a horse with 0.60 as they stand, with an arm that
# becomes the tail, and with 0.49 after a quarter turn, symmetrically.
_ASKEW = 0.75
# What a map that turns a body over counts. A caterpillar maps onto a butterfly with 0.76 upside down and back to front;
# a fish maps onto it with 0.26 upside down, and with 0.25 upright.
_TURNED_OVER = 0.5
# A turn must not make shapes stretch more than this number of times as much: 1.23 from someone who kneels to one who
# kicks, back to front with a score of 0.97, and rightly with 0.63. From a man to an ogre who looks the other way, the
# right map stretches them 1.02 times as much as the wrong one; from animals to others, chairs and hands that face
# different ways, it is 0.76 to 1.06 times as much.
_MORE_STRETCHED = 1.1
# Scores that differ by less are the same. Someone who kneels maps onto someone who sits on the floor with 0.988, and,
# after half a turn, back to front with 0.991.
_SAME = 0.01

TRUSTED = 0.88
"""With this score, shapes map onto each other beyond doubt; chosen by eye on pairs of the benchmark."""


@dataclass(frozen=True)
class MappedPair:
    """Two registered shapes.

    Attributes
    ----------
    laid : LaidPair
        The registrations.
    map : PairMap
        The map between the shapes, with the score of the registrations if these were not started from it.
    symmetry : float or None
        Share of the surface on which the registrations keep left and right, from 0 to 1; None for shapes without a
        common mirror plane, with guides that contradict it, and where no map was needed.
    detour : float
        Length of the registrations over the Wasserstein distance; see :func:`.map_detour.map_detour`.
    turn : float
        Angle in degrees by which the first shape was turned about the vertical axis for the registration.
    is_turned_over : bool
        Whether a registration turns its shape over.
    stretch : float
        Mean logarithmic stretch of both surfaces, apart from their scaling as a whole.
    tumbles : bool
        Whether a registration turns its shape far around, and not about the vertical axis.
    by_vertices : bool
        Whether vertices with the same number correspond; see :mod:`.corresponding_vertices`.
    """

    laid: LaidPair
    map: PairMap
    symmetry: float | None
    detour: float
    turn: float = 0.0
    is_turned_over: bool = False
    stretch: float = 0.0
    tumbles: bool = False
    by_vertices: bool = False

    @property
    def is_lopsided(self) -> bool:
        """Whether symmetric shapes seem to face opposite ways."""
        return self.symmetry is not None and (self.symmetry < _LOPSIDED or self.detour > _DETOUR)

    @property
    def score(self) -> float:
        """Score of the map, 0 to 1, or the confidence in the registrations as far as they keep left and right."""
        return max(self.map.score, (self.symmetry or 0.0) * self.laid.confidence)

    @property
    def merit(self) -> float:
        """The score to compare maps: below `TRUSTED`, less if turned over or without a common mirror plane."""
        if self.score >= TRUSTED:
            return self.score
        return self.score * (_ASKEW if self.symmetry is None else 1.0) * (_TURNED_OVER if self.is_turned_over else 1.0)

    def stretches_more_than(self, other: MappedPair) -> bool:
        """Whether it stretches shapes more than another one in the same turn, or clearly more than in another turn."""
        return self.stretch > (1.0 if self.turn == other.turn else _MORE_STRETCHED) * other.stretch


def better(standing: MappedPair, turned: MappedPair) -> MappedPair:
    """Return the one of two registrations of a pair that follows more guides, or else has the higher merit.

    Without guides, they are not turned if that stretches them clearly more, or, if both registrations are beyond doubt
    and have the same score, at all more: people are alike in front and at the back, but for their feet, hands and
    faces.
    """
    if len(standing.map.pairs) != len(turned.map.pairs):
        return max(standing, turned, key=lambda pair: len(pair.map.pairs))
    if not len(standing.map.pairs) and turned.stretches_more_than(standing):
        return standing
    if min(standing.score, turned.score) >= TRUSTED and abs(standing.score - turned.score) < _SAME:
        return min(standing, turned, key=lambda pair: pair.stretch)
    return max(standing, turned, key=lambda pair: pair.merit)
