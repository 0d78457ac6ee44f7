# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Refuse a job that would not fit in memory, before it starts."""

from __future__ import annotations

import ctypes
import os
import sys

from ..errors import ResourceError


def check_memory(needed: int, resolution: int, workers: int = 1) -> None:
    """Raise where a job needs more bytes than the machine has free.

    Parameters
    ----------
    needed : int
        Bytes at the peak of the job.
    resolution : int
        Cells along the longest side, to say which resolution would fit.
    workers : int
        Threads that solve; where there are several, fewer are another way out.

    Raises
    ------
    ResourceError
        With what is needed, what there is, and the resolution that fits.
    """
    free = available_memory()
    if free is None or needed <= free:
        return
    # Sides are rounded up and margins do not shrink, so a coarser grid takes a little more than its share.
    fitting = int(resolution * (0.7 * free / needed) ** (1.0 / 3.0))
    figures = {"resolution": resolution, "needed": needed / 1e9, "free": free / 1e9, "fitting": fitting}
    if workers == 1:
        raise ResourceError(
            "Resolution {resolution} needs about {needed:.1f} GB of memory and {free:.1f} GB are free. Resolution "
            "{fitting} would fit.",
            **figures,
        )
    raise ResourceError(
        "Resolution {resolution} needs about {needed:.1f} GB of memory and {free:.1f} GB are free. Resolution "
        "{fitting} would fit. Fewer workers than {workers} need less.",
        **figures,
        workers=workers,
    )


def fitting_beside(needed: int, each: int, most: int) -> int:
    """Return how many things, up to `most`, that take `each` bytes fit in memory beside a job's peak of `needed` bytes.

    None may fit: they are things that the job can do without.
    """
    free = available_memory()
    return most if free is None else min(max((free - needed) // each, 0), most)


def available_memory() -> int | None:
    """Bytes of memory that can be used without swapping; None where the system does not say."""
    if sys.platform == "win32":
        return _available_windows()
    try:
        with open("/proc/meminfo", encoding="ascii") as lines:
            for line in lines:
                if line.startswith("MemAvailable:"):
                    return int(line.split()[1]) * 1024
    except OSError:
        pass
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (ValueError, OSError):
        return None


def _available_windows() -> int | None:
    class MemoryStatus(ctypes.Structure):
        _fields_ = (
            ("length", ctypes.c_ulong),
            ("load", ctypes.c_ulong),
            *((name, ctypes.c_ulonglong) for name in ("total", "available", "a", "b", "c", "d", "e")),
        )

    status = MemoryStatus(length=ctypes.sizeof(MemoryStatus))
    if not ctypes.windll.kernel32.GlobalMemoryStatusEx(ctypes.byref(status)):
        return None
    return int(status.available)
