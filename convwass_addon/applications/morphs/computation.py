# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where and how the frames of a bake are computed."""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass

from ..motions.motion_memory import MotionMemory
from ..workers import thread_count
from .frame_cache import FrameCache


@dataclass(frozen=True)
class Computation:
    """Which frames are computed, by which threads or processes, what is cached, and whether there are previews.

    The frames are the same however they are computed. Flat shapes are computed quickly: their frames are neither
    cached, nor sent to other machines, nor previewed.

    Attributes
    ----------
    workers : int or None
        Threads that compute short runs of blends in parallel; None for one per processor, as far as memory allows.
    executor : concurrent.futures.Executor or None
        Computes the runs in other processes or on other machines instead. The control is then checked by the waiting
        thread only, and runs that have started are left to finish.
    cache : FrameCache or None
        Frames in the cache are not computed again; new frames are stored at once.
    wanted : range or None
        Indices of the blends to compute; None for all. Runs are always computed as a whole, so that frames do not
        depend on how a morph is split.
    previews : bool
        Whether to solve the coarse levels of all blends first and yield previews. There are none if an executor is
        given, if the grid has no coarser level, and for runs beyond the available memory.
    looked_at : int
        Index of the displayed blend, among those to compute: previews near it come first.
    motions : MotionMemory or None
        Motions in the memory are not computed again.

    Raises
    ------
    InputError
        `workers` is less than one.
    """

    workers: int | None = None
    executor: Executor | None = None
    cache: FrameCache | None = None
    wanted: range | None = None
    previews: bool = False
    looked_at: int = 0
    motions: MotionMemory | None = None

    def __post_init__(self) -> None:
        thread_count(self.workers)


USUAL_COMPUTATION = Computation()
"""All frames, by the threads of this machine, without a cache and without previews."""
