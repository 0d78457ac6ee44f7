# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Coherence of a motion, from 0 to 1: up to a half, how far shapes move, and beyond, how much they resist changes."""

from __future__ import annotations

from ...errors import InputError

FULL_COHERENCE = 0.5
"""Coherence at which shapes move all of the way."""


def check_coherence(coherence: float) -> None:
    """Raise InputError if a coherence is not between 0 and 1."""
    if not 0.0 <= coherence <= 1.0:
        raise InputError("The coherence must lie between 0 and 1.")


def way_at(coherence: float) -> float:
    """Return the fraction of the way towards the others that shapes move, from 0 to 1."""
    return min(coherence / FULL_COHERENCE, 1.0)


def excess_at(coherence: float) -> float:
    """Return how far a coherence is beyond the full one, from 0 to 1."""
    return max(coherence - FULL_COHERENCE, 0.0) / (1.0 - FULL_COHERENCE)
