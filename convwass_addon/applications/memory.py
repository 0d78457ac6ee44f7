# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Check before a job starts that it fits in memory."""

from __future__ import annotations

import ctypes
import os
import sys

from ..errors import ResourceError


def check_memory(needed: int, resolution: int, workers: int = 1) -> None:
    """Raise if a job needs more memory than is free.

    Parameters
    ----------
    needed : int
        Peak memory of the job in bytes.
    resolution : int
        Cells along the longest side; the message suggests a resolution that would fit.
    workers : int
        Number of solving threads; if there are several, the message also suggests fewer.

    Raises
    ------
    ResourceError
        The message states the needed and the free memory, and the resolution that fits.
    """
    free = available_memory()
    if free is None or needed <= free:
        return
    # Sides are rounded up and margins do not shrink, so a coarser grid needs slightly more than in proportion.
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
    """Return how many optional items of `each` bytes fit beside a job's peak of `needed` bytes, at most `most`.

    The result may be zero.
    """
    free = available_memory()
    return most if free is None else min(max((free - needed) // each, 0), most)


def available_memory() -> int | None:
    """Memory in bytes available without swapping; None if the system does not report it."""
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
