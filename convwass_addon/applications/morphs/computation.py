# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How the frames of a bake are computed, whatever they show."""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass

from .frame_cache import FrameCache


@dataclass(frozen=True)
class Computation:
    """By whom frames are computed, where they are kept, and which of them are wanted.

    See :func:`.morph.morph`. Frames of flat shapes are there soon: they are neither cached nor sent to other machines,
    nor previewed.

    Attributes
    ----------
    workers : int or None
        Threads; None for one per processor.
    executor : concurrent.futures.Executor or None
        Other processes or machines instead.
    cache : FrameCache or None
        What keeps frames.
    wanted : range or None
        Indices of blends; None for all.
    previews : bool
        Whether what can be seen early is yielded.
    """

    workers: int | None = None
    executor: Executor | None = None
    cache: FrameCache | None = None
    wanted: range | None = None
    previews: bool = False
