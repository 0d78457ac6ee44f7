# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""CPU and wall seconds with pauses."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator


class Clock:
    """Seconds since its creation, without pauses."""

    def __init__(self) -> None:
        self._cpu, self._wall = time.process_time(), time.perf_counter()

    def read(self) -> dict[str, float]:
        """Return CPU and wall seconds."""
        return {"cpu": time.process_time() - self._cpu, "wall": time.perf_counter() - self._wall}

    @contextlib.contextmanager
    def paused(self) -> Iterator[None]:
        """Pause the clock while the body runs."""
        before = self.read()
        try:
            yield
        finally:
            after = self.read()
            self._cpu += after["cpu"] - before["cpu"]
            self._wall += after["wall"] - before["wall"]
