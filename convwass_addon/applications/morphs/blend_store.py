# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What is known of blends, kept in memory so that it need not be computed again."""

from __future__ import annotations

import threading
from typing import Generic, TypeVar

from .layouts import Blend

Kept = TypeVar("Kept")


class BlendStore(Generic[Kept]):
    """One value per blend, as many as fit in a number of bytes; shared by all threads, and empty in other processes.

    Parameters
    ----------
    most : int
        Maximum number of bytes. Values beyond it are not kept.
    """

    def __init__(self, most: int) -> None:
        self._left = most
        self._values: dict[Blend, Kept] = {}
        self._lock = threading.Lock()

    def __reduce__(self) -> tuple[type[BlendStore], tuple[int]]:
        return BlendStore, (0,)

    def keep(self, blend: Blend, value: Kept, size: int) -> None:
        """Keep the value of a blend, which takes `size` bytes, if it fits and the blend has none."""
        with self._lock:
            if size <= self._left and blend not in self._values:
                self._left -= size
                self._values[blend] = value

    def __contains__(self, blend: Blend) -> bool:
        return blend in self._values

    def get(self, blend: Blend) -> Kept | None:
        """Return the value of a blend, if it is kept."""
        return self._values.get(blend)
