# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Scene frames over which the steps of a blend are distributed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Frames:
    """Scene frames from the first to the last step."""

    first: int
    last: int

    def of(self, count: int) -> list[float]:
        """Return the frames of this number of steps."""
        return np.linspace(self.first, self.last, count).tolist()
