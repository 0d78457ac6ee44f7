# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How long work is stopped: it calls a check every now and then, which raises."""

from __future__ import annotations

from collections.abc import Callable

Check = Callable[[], None]
"""Called between iterations; what it raises (:class:`.errors.Cancelled`) ends the work."""


def monitor_of(check: Check | None) -> Callable[[int, int, float], None] | None:
    """Turn a check into what solvers call once per iteration."""
    return None if check is None else lambda *_: check()
