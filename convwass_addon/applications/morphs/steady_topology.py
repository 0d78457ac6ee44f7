# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pieces and handles along a whole morph: they change as seldom as can be between two shapes.

Every blend is mended by itself, with no more pieces and handles than its shapes have. Where that leaves some blends
with fewer than their neighbors, counts flicker. Here they are decided over all blends between two shapes; those that
have more than was decided are asked for again.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from ...geometry.connectivity import Connectivity
from .fewest_changes import fewest_changes
from .layouts import Blend
from .morph_problem import MorphFrame

# What is decided over the blends; bubbles are not seen.
_DECIDED = ("pieces", "handles")
# The fewest of each that a solid has.
_LEAST = Connectivity(1, 0, 0)


@dataclass(frozen=True)
class Leg:
    """Blends between two shapes of a path.

    Attributes
    ----------
    first, last : Blend
        The shapes as they are.
    between : tuple of Blend
        In their order.
    """

    first: Blend
    last: Blend
    between: tuple[Blend, ...]


def legs_of(blends: Sequence[Blend]) -> list[Leg]:
    """Return the legs of a path, those without blends between their shapes left out; a sheet has none."""
    shapes = [index for index, blend in enumerate(blends) if blend.source is not None and blend.frame is not None]
    found = [Leg(blends[start], blends[end], tuple(blends[start + 1 : end])) for start, end in pairwise(shapes)]
    return [leg for leg in found if leg.between]


@dataclass
class _Counts:
    """What a blend has, what it cannot have less of, and what its shapes have at the most."""

    has: Connectivity
    least: Connectivity
    most: Connectivity


class SteadyTopology:
    """Hears what every blend has, and says which should have less.

    Parameters
    ----------
    legs : sequence of Leg
        All blends that are decided over.
    """

    def __init__(self, legs: Sequence[Leg]) -> None:
        self._legs = legs
        self._shapes: dict[Blend, Connectivity] = {}
        self._counts: dict[Blend, _Counts] = {}

    def hear(self, frame: MorphFrame) -> None:
        """Take note of what a frame has; of frames that are not mended nothing is known."""
        has, most = _connectivity(frame, "found"), _connectivity(frame, "most")
        if has is None:
            return
        if frame.blend.source is not None:
            self._shapes[frame.blend] = has
        elif most is not None:
            self._counts[frame.blend] = _Counts(has, _LEAST, most)

    def asked(self) -> dict[Blend, Connectivity]:
        """Return the most that blends should have which have more than that now, in the order of the blends."""
        found: dict[Blend, Connectivity] = {}
        for leg in self._legs:
            if self._knows(leg):
                found |= self._asked_of(leg)
        return found

    def knows(self, blends: Iterable[Blend]) -> bool:
        """Whether frames of all of these have been heard of that are mended."""
        return all(blend in self._counts for blend in blends)

    def most(self, blend: Blend) -> Connectivity:
        """Return the most that the shapes of a blend have which is known."""
        return self._counts[blend].most

    def better(self, frame: MorphFrame, asked: Connectivity) -> MorphFrame | None:
        """Take note of a frame that was made again, and return it; None where the one before is as good.

        Parameters
        ----------
        frame : MorphFrame
            A blend that was asked for.
        asked : Connectivity
            The most that it should have had.
        """
        counts, has = self._counts[frame.blend], _connectivity(frame, "found")
        is_better = has.beyond(asked) < counts.has.beyond(asked)
        if is_better:
            counts.has = has
        # Nothing is asked for twice.
        left = {kind: getattr(counts.has, kind) for kind in _DECIDED if _exceeds(counts.has, asked, kind)}
        counts.least = replace(counts.least, **left)
        if not is_better:
            return None
        return replace(frame, record={**frame.record, "most": vars(counts.most)})

    def _knows(self, leg: Leg) -> bool:
        return {leg.first, leg.last} <= self._shapes.keys() and self._counts.keys() >= set(leg.between)

    def _asked_of(self, leg: Leg) -> dict[Blend, Connectivity]:
        own = [self._counts[blend] for blend in leg.between]
        decided = {kind: self._fewest(leg, kind) for kind in _DECIDED}
        wanted = [
            replace(counts.most, **{kind: decided[kind][place] for kind in _DECIDED})
            for place, counts in enumerate(own)
        ]
        return {
            blend: most
            for blend, most, counts in zip(leg.between, wanted, own, strict=True)
            if any(_exceeds(counts.has, most, kind) for kind in _DECIDED)
        }

    def _fewest(self, leg: Leg, kind: str) -> list[int]:
        own = [self._counts[blend] for blend in leg.between]
        least = [getattr(counts.least, kind) for counts in own]
        most = [getattr(counts.has, kind) for counts in own]
        first, last = (getattr(self._shapes[end], kind) for end in (leg.first, leg.last))
        return fewest_changes(least, most, first, last)


def _connectivity(frame: MorphFrame, name: str) -> Connectivity | None:
    """Return counts of a record, which may come from a file; None where it has none."""
    counts = frame.record.get(name)
    if not isinstance(counts, dict) or counts.keys() != vars(_LEAST).keys():
        return None
    return Connectivity(**counts) if all(type(count) is int for count in counts.values()) else None


def _exceeds(has: Connectivity, most: Connectivity, kind: str) -> bool:
    return getattr(has, kind) > getattr(most, kind)
