# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where and how the frames of a bake are computed."""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass

from ..motions.motion_memory import MotionMemory
from .frame_cache import FrameCache


@dataclass(frozen=True)
class Computation:
    """Which frames are computed, by which threads or processes, and what is cached.

    See :func:`.morph.morph`. Flat shapes are computed quickly: their frames are neither cached, nor sent to other
    machines, nor previewed.

    Attributes
    ----------
    workers : int or None
        Number of threads; None for one per processor.
    executor : concurrent.futures.Executor or None
        Other processes or machines to use instead.
    cache : FrameCache or None
        Stores finished frames.
    wanted : range or None
        Indices of the blends to compute; None for all.
    previews : bool
        Whether previews are yielded.
    motions : MotionMemory or None
        Stores motions.
    """

    workers: int | None = None
    executor: Executor | None = None
    cache: FrameCache | None = None
    wanted: range | None = None
    previews: bool = False
    motions: MotionMemory | None = None
