# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pair the limbs of a person with those of an animal or another person: head and head, front legs and arms.

A map between the surfaces of an animal and a person can be consistent and still wrong: a raised tail becomes the head.
Limbs are few, so all ways to pair them can be compared by what is near their tips, by how high these are, and by how
far they are from each other on the surface. The best way serves as guides for a map.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.meshes.mirror_planes import MirrorPlanes
from .limb_tips import Limb, Limbs

# Shapes with more limbs, or pairs of limbs, than this are not compared. A spider has six.
_MOST_LIMBS = 8
# Limbs do not correspond if the cost of the best pairing is more than this share of that of no pairing. It is 0.2 to
# 0.46 from a dog, a chair, a camel, a kangaroo or a crocodile to a man, and 0.52 from an elephant, of which the tail
# would become his head.
_MOST_COST = 0.48


@dataclass(frozen=True)
class LimbPairs:
    """The limbs that two shapes have in common.

    Attributes
    ----------
    tips : (k, 2) int64
        Corresponding tips, as vertices; empty if the limbs do not correspond.
    facing : int
        1 if the shapes look in the same direction, -1 if they look in opposite ones, and 0 if that is not known.
    """

    tips: NDArray[np.int64]
    facing: int


def limb_pairs(first: TriangleMesh, second: TriangleMesh, planes: MirrorPlanes) -> LimbPairs:
    """Pair the limbs of two shapes of which at most one is long.

    Limbs in the mirror plane are paired with each other, and pairs of limbs with pairs, left with left. The cost of a
    pairing is the sum of the differences of paired tips, in the logarithm of the surface around them and in height, of
    the mean differences of their distances from other tips, and of the bulk of limbs without a counterpart.

    Parameters
    ----------
    first, second : TriangleMesh
        The shapes, best of a few thousand vertices.
    planes : (MirrorPlane, MirrorPlane)
        Parallel planes in which they are nearly symmetric.
    """
    one, other = (Limbs.of(mesh, plane) for mesh, plane in zip((first, second), planes, strict=True))
    if not (0 < len(one.limbs) <= _MOST_LIMBS and 0 < len(other.limbs) <= _MOST_LIMBS):
        return _NONE
    # The raised tail of an animal is more like the head of another one than its own head is.
    if one.is_long and other.is_long:
        return _NONE
    found, cost = best_pairing(one, other)
    if not found or cost > _MOST_COST * (one.costs.sum() + other.costs.sum()):
        return _NONE
    here, there = ([[pair[k] for pair in pairs] for pairs in found] for k in (0, 1))
    ends = one.vertices[np.concatenate(here)], other.vertices[np.concatenate(there)]
    facing = one.heading(here) * other.heading(there)
    return LimbPairs(np.stack(ends, axis=1), facing)


_NONE = LimbPairs(np.empty((0, 2), np.int64), 0)

TipPairs = list[tuple[int, int]]
"""Corresponding tips of two limbs."""


def best_pairing(one: Limbs, other: Limbs) -> tuple[list[TipPairs], float]:
    """Return the pairs of tips of all paired limbs of two shapes in the best pairing, and its cost."""
    choices = [
        _Choice(limb, counterpart, pairs)
        for limb, own in enumerate(one.limbs)
        for counterpart, there in enumerate(other.limbs)
        if (pairs := _paired(own, there))
    ]
    search = _Search(one, other, choices)
    search.extend(0, [], float(other.costs.sum()), search.own)
    return [choices[number].pairs for number in search.best], search.cost


@dataclass(frozen=True)
class _Choice:
    """Two limbs that may be paired: their places in the lists of limbs, and the corresponding tips."""

    limb: int
    counterpart: int
    pairs: TipPairs


class _Search:
    """Finds the pairing of the lowest cost by branch and bound.

    The cost of what is left is at least that of the best choice for every limb by itself, given those made before.
    """

    def __init__(self, one: Limbs, other: Limbs, choices: list[_Choice]) -> None:
        self.limb = np.array([choice.limb for choice in choices], np.int64)
        self.counterpart = np.array([choice.counterpart for choice in choices], np.int64)
        self.alone = one.costs
        between = np.array([[_distortion(one, other, a.pairs, b.pairs) for b in choices] for a in choices])
        self.between = between.reshape(len(choices), len(choices))
        # A pairing saves what the counterpart would cost alone.
        differences = [_difference(one, other, choice.pairs) for choice in choices]
        self.own = np.array(differences) + 0.5 * np.diagonal(self.between) - other.costs[self.counterpart]
        self.best: list[int] = []
        self.cost = float(one.costs.sum() + other.costs.sum())

    def extend(self, limb: int, chosen: list[int], cost: float, more: NDArray[np.float64]) -> None:
        """Choose counterparts of a limb of the first shape and those that follow it.

        Parameters
        ----------
        limb : int
            The limb.
        chosen : list of int
            Choices for the limbs before it.
        cost : float
            Cost of these, of limbs before it that have no counterpart, and of the limbs of the other shape without one.
        more : (c,) float64
            What every choice adds to it; infinite for counterparts that are taken.
        """
        if limb == len(self.alone):
            if cost < self.cost:
                self.best, self.cost = chosen, cost
            return
        least = self.alone[limb:].copy()
        np.minimum.at(least, self.limb[self.limb >= limb] - limb, more[self.limb >= limb])
        if cost + least.sum() >= self.cost:
            return
        own = np.flatnonzero((self.limb == limb) & (more < np.inf))
        for choice in own[np.argsort(more[own], kind="stable")].tolist():
            taken = self.counterpart == self.counterpart[choice]
            later = np.where(taken, np.inf, more + self.between[choice])
            self.extend(limb + 1, [*chosen, choice], cost + more[choice], later)
        self.extend(limb + 1, chosen, cost + self.alone[limb], more)


def _difference(one: Limbs, other: Limbs, pairs: TipPairs) -> float:
    """Return the differences of paired tips in the surface around them and in height."""
    here, there = np.array(pairs).T
    bulks = np.abs(np.log(one.shares[here] / other.shares[there]))
    return float((bulks + np.abs(one.heights[here] - other.heights[there])).sum())


def _distortion(one: Limbs, other: Limbs, pairs: TipPairs, others: TipPairs) -> float:
    """Return the differences of the distances between paired tips and others, relative to the number of tips."""
    (here, there), (here2, there2) = np.array(pairs).T, np.array(others).T
    differences = one.apart[np.ix_(here, here2)] - other.apart[np.ix_(there, there2)]
    return float(2.0 * np.abs(differences).sum() / max(min(one.count, other.count) - 1, 1))


def _paired(limb: Limb, other: Limb) -> TipPairs:
    """Return the corresponding tips of two limbs; none if one is in the middle and the other one is not."""
    if len(limb.tips) == len(other.tips):
        return list(zip(limb.tips, other.tips, strict=True))
    if limb.middle is None or other.middle is None:
        return []
    return [(limb.middle, other.middle)]
