# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the thread that may read Blender's data hands it to the one that works on it."""

from __future__ import annotations

import queue
from typing import Generic, TypeVar

from ..progress import UNINTERRUPTED, Control

Item = TypeVar("Item")

# Seconds between two looks at whether the job is to end, while it waits.
_PATIENCE = 0.05


class Desk(Generic[Item]):
    """Where things are handed over that a step of a job has asked for."""

    def __init__(self) -> None:
        self._items: queue.SimpleQueue[Item] = queue.SimpleQueue()

    def hand_over(self, item: Item) -> None:
        """Give what the last step has asked for."""
        self._items.put(item)

    def take(self, control: Control = UNINTERRUPTED) -> Item:
        """Return it; where nobody else could hand it over by now, it must be there."""
        while control is not UNINTERRUPTED:
            control.check()
            try:
                return self._items.get(timeout=_PATIENCE)
            except queue.Empty:
                continue
        return self._items.get_nowait()
