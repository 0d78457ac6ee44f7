# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of live morphs besides those of a morph."""

from __future__ import annotations

from dataclasses import dataclass

from ...schema import Settings, setting


@dataclass(frozen=True)
class LiveSettings(Settings):
    """Settings of a live morph."""

    live_resolution: int = setting(
        64,
        "Resolution",
        "Cells along the longest side of the volume while the morph is live; 48 is quick, 100 is fine",
        least=24,
        most=256,
        soft_most=128,
        unit="cells",
    )
    live_memory: int = setting(
        512,
        "Memory",
        "Maximum memory for stored blends; if it is too small, the lattice of blends is coarser",
        least=1,
        soft_least=64,
        most=16_384,
        unit="MB",
    )
