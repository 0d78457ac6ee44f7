# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Solved blends, kept so that their surfaces can be extracted again without solving them again."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...transport import Barycenter
from ...transport.potentials import Potentials
from ...transport.region import Region
from .blend_solver import SolvedBlend
from .blend_store import BlendStore
from .layouts import Blend


class KeptBlends:
    """Solved blends in a compact form, as many as fit in a number of bytes; shared by all threads.

    Parameters
    ----------
    most : int
        Maximum number of bytes. Blends beyond it are not kept.
    finest : bool
        Whether to keep the potentials of the finest level, too, which frames with potentials need. They take more
        memory than everything else.
    """

    def __init__(self, most: int, *, finest: bool = False) -> None:
        self._store: BlendStore[_KeptBlend] = BlendStore(most)
        self._finest = finest

    def keep(self, solved: SolvedBlend) -> None:
        """Keep a blend if it fits."""
        kept = _KeptBlend.of(solved, self._finest)
        self._store.keep(solved.blend, kept, kept.bytes)

    def __contains__(self, blend: Blend) -> bool:
        return blend in self._store

    def solved(self, blend: Blend) -> SolvedBlend:
        """Return a kept blend exactly as it was solved, without the levels that its surface does not need."""
        return self._store.get(blend).solved()


@dataclass(frozen=True)
class _KeptBlend:
    """A solved blend whose parts are kept."""

    frame: SolvedBlend
    """Without its parts."""
    parts: tuple[_KeptPart, ...]

    @classmethod
    def of(cls, solved: SolvedBlend, finest: bool) -> _KeptBlend:
        return cls(replace(solved, parts=()), tuple(_KeptPart.of(part, finest) for part in solved.parts))

    @property
    def bytes(self) -> int:
        return sum(part.bytes for part in self.parts)

    def solved(self) -> SolvedBlend:
        return replace(self.frame, parts=tuple(part.solved() for part in self.parts))


@dataclass(frozen=True)
class _KeptPart:
    """A barycenter whose values are kept only where it may have mass."""

    figures: Barycenter
    """Without its density and its levels."""
    shape: tuple[int, ...]
    inside: NDArray[np.uint8]
    """Packed mask of the cells where it may have mass."""
    density: NDArray[np.float64]
    """At these cells."""
    levels: tuple[Potentials, ...]
    """Its second finest level, from which origins are computed, or its only one, with little else."""
    finest: Potentials | None
    """Its finest level without a region."""

    @classmethod
    def of(cls, part: Barycenter, finest: bool) -> _KeptPart:
        last = part.levels[-1]
        return cls(
            figures=replace(part, density=np.empty(0), levels=()),
            shape=part.density.shape,
            inside=np.packbits(last.region.inside),
            density=last.region.gather(part.density),
            levels=tuple(replace(level, region=Region(level.region.inside)) for level in part.levels[-2:-1]),
            # The finest level is the second finest of a grid without coarser ones.
            finest=replace(last, region=None) if finest or len(part.levels) == 1 else None,
        )

    @property
    def bytes(self) -> int:
        known = [level for level in (*self.levels, self.finest) if level is not None]
        arrays = [array for level in known for array in (level.log_v, level.log_debias)]
        regions = sum(level.region.inside.nbytes for level in self.levels)
        return self.inside.nbytes + self.density.nbytes + regions + sum(array.nbytes for array in arrays)

    def solved(self) -> Barycenter:
        inside = np.unpackbits(self.inside, count=int(np.prod(self.shape))).astype(bool).reshape(self.shape)
        region = Region(inside)
        nothing = Potentials(region, np.empty((0, 0)), np.empty(0))
        finest = nothing if self.finest is None else replace(self.finest, region=region)
        density = region.scatter(self.density, 0.0)
        return replace(self.figures, density=density, levels=(*self.levels, finest))
