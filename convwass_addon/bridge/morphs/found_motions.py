# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The motions that live morphs and bakes of this session share."""

from __future__ import annotations

from ...applications.motions.motion_memory import MotionMemory

FOUND_MOTIONS = MotionMemory()
"""A bake after a live morph, or with other settings than the last one, does not search for its motion again."""
