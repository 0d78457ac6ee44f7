# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames of the scene that the steps of a blend are spread over."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Frames:
    """Frames of the scene from the first to the last step."""

    first: int
    last: int

    def of(self, count: int) -> list[float]:
        """Return where so many steps lie."""
        return np.linspace(self.first, self.last, count).tolist()
