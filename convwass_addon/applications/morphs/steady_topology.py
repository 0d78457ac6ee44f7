# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Choose the numbers of pieces and handles along a morph so that they change as rarely as possible.

Every blend is repaired by itself, with at most as many pieces and handles as its shapes have. If some blends end up
with fewer than their neighbors, the counts flicker. Here they are chosen for all blends between two shapes together;
blends with more than the chosen number are to be computed again.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import groupby, pairwise

from ...geometry.level_sets.connectivity import Connectivity
from .fewest_changes import fewest_changes
from .layouts import Blend
from .morph_problem import MorphFrame

# The counts that are chosen; bubbles are invisible.
_DECIDED = ("pieces", "handles")
# The smallest counts of a solid.
_LEAST = Connectivity(1, 0, 0)


@dataclass(frozen=True)
class Leg:
    """The blends between two neighboring shapes of a path.

    Attributes
    ----------
    first, last : Blend
        The unblended shapes.
    between : tuple of Blend
        The blends between them, in order.
    """

    first: Blend
    last: Blend
    between: tuple[Blend, ...]

    @property
    def whole(self) -> tuple[Blend, ...]:
        """All blends in order, with the unblended shapes."""
        return (self.first, *self.between, self.last)


def legs_of(blends: Sequence[Blend]) -> list[Leg]:
    """Return the legs of a path, without those that have no blends between their shapes; a sheet has none."""
    shapes = [index for index, blend in enumerate(blends) if blend.source is not None and blend.frame is not None]
    found = [Leg(blends[start], blends[end], tuple(blends[start + 1 : end])) for start, end in pairwise(shapes)]
    return [leg for leg in found if leg.between]


def leg_with(legs: Iterable[Leg], blend: Blend) -> Leg:
    """Return the leg that has a blend between its shapes."""
    return next(leg for leg in legs if blend in leg.between)


@dataclass
class _Counts:
    """Counts of a blend, their lower bounds, and the maximum over its shapes."""

    has: Connectivity
    least: Connectivity
    most: Connectivity


class SteadyTopology:
    """Collects the counts of all blends, and finds those that should have fewer.

    Parameters
    ----------
    legs : sequence of Leg
        The legs for which counts are chosen.
    """

    def __init__(self, legs: Sequence[Leg]) -> None:
        self._legs = legs
        self._shapes: dict[Blend, Connectivity] = {}
        self._counts: dict[Blend, _Counts] = {}

    def add(self, frame: MorphFrame) -> None:
        """Add the counts of a frame; frames that were not repaired have none."""
        has, most = _connectivity(frame, "found"), _connectivity(frame, "most")
        if has is None:
            return
        if frame.blend.source is not None:
            self._shapes[frame.blend] = has
        elif most is not None:
            self._counts[frame.blend] = _Counts(has, _LEAST, most)

    def asked(self) -> dict[Blend, Connectivity]:
        """Return the largest allowed counts of the blends that exceed them, in the order of the blends."""
        found: dict[Blend, Connectivity] = {}
        for leg in self._known_legs():
            found |= self._exceeding(leg, [self._counts[blend].least for blend in leg.between])
        return found

    def unreached(self) -> dict[Blend, Connectivity]:
        """Return single blends that could not be repaired to the counts of their neighbors, with these counts."""
        found: dict[Blend, Connectivity] = {}
        for leg in self._known_legs():
            exceeding = self._exceeding(leg, [_LEAST] * len(leg.between))
            runs = [list(run) for exceeds, run in groupby(leg.between, exceeding.__contains__) if exceeds]
            found |= {run[0]: exceeding[run[0]] for run in runs if len(run) == 1}
        return found

    def beside(self, blend: Blend) -> tuple[Blend, ...]:
        """Return the blends next to a blend in its leg."""
        between = leg_with(self._legs, blend).between
        place = between.index(blend)
        return (*between[max(place - 1, 0) : place], *between[place + 1 : place + 2])

    def knows(self, blends: Iterable[Blend]) -> bool:
        """Whether counts of all these blends are known."""
        return all(blend in self._counts for blend in blends)

    def most(self, blend: Blend) -> Connectivity:
        """Return the maximum counts over the shapes of a blend; they must be known."""
        return self._counts[blend].most

    def has(self, blend: Blend) -> Connectivity:
        """Return the counts of a blend so far; they must be known."""
        return self._counts[blend].has

    def reaches(self, frame: MorphFrame, most: Connectivity) -> bool:
        """Whether a frame exceeds none of some counts."""
        has = _connectivity(frame, "found")
        return has is not None and not _exceeds_any(has, most)

    def better(self, frame: MorphFrame, asked: Connectivity) -> MorphFrame | None:
        """Add the counts of a frame that was computed again, and return it; None if it is no better than before.

        Parameters
        ----------
        frame : MorphFrame
            A blend from `asked`.
        asked : Connectivity
            Its largest allowed counts.
        """
        counts, has = self._counts[frame.blend], _connectivity(frame, "found")
        is_better = has.beyond(asked) < counts.has.beyond(asked)
        if is_better:
            counts.has = has
        # Counts that could not be reached become lower bounds, so that they are not asked for again.
        left = {kind: getattr(counts.has, kind) for kind in _DECIDED if _exceeds(counts.has, asked, kind)}
        counts.least = replace(counts.least, **left)
        if not is_better:
            return None
        return replace(frame, record={**frame.record, "most": vars(counts.most)})

    def _known_legs(self) -> list[Leg]:
        return [leg for leg in self._legs if {leg.first, leg.last} <= self._shapes.keys() and self.knows(leg.between)]

    def _exceeding(self, leg: Leg, least: Sequence[Connectivity]) -> dict[Blend, Connectivity]:
        """Return the largest counts of those blends that exceed them, if counts can be reduced to some least ones."""
        own = [self._counts[blend] for blend in leg.between]
        decided = {kind: self._fewest(leg, least, kind) for kind in _DECIDED}
        wanted = [
            replace(counts.most, **{kind: decided[kind][place] for kind in _DECIDED})
            for place, counts in enumerate(own)
        ]
        return {
            blend: most
            for blend, most, counts in zip(leg.between, wanted, own, strict=True)
            if _exceeds_any(counts.has, most)
        }

    def _fewest(self, leg: Leg, least: Sequence[Connectivity], kind: str) -> list[int]:
        most = [getattr(self._counts[blend].has, kind) for blend in leg.between]
        first, last = (getattr(self._shapes[end], kind) for end in (leg.first, leg.last))
        return fewest_changes([getattr(counts, kind) for counts in least], most, first, last)


def _connectivity(frame: MorphFrame, name: str) -> Connectivity | None:
    """Return counts from a record, which may come from a file; None if they are missing or invalid."""
    counts = frame.record.get(name)
    if not isinstance(counts, dict) or counts.keys() != vars(_LEAST).keys():
        return None
    return Connectivity(**counts) if all(type(count) is int for count in counts.values()) else None


def _exceeds_any(has: Connectivity, most: Connectivity) -> bool:
    return any(_exceeds(has, most, kind) for kind in _DECIDED)


def _exceeds(has: Connectivity, most: Connectivity, kind: str) -> bool:
    return getattr(has, kind) > getattr(most, kind)
