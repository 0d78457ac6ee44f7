# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A bake into a cache, in a separate process that may be killed: python -m tests.fuzz.killed_bake FOLDER."""

from __future__ import annotations

import sys
from pathlib import Path

from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.frame_cache import FrameCache
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph import morph
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_problem import MorphFrame
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from tests.shapes import ball, box

FRAMES = 12


def bake(cache: FrameCache | None) -> list[MorphFrame]:
    """Return all frames."""
    settings, computation = MorphSettings(motion="transport", resolution=16), Computation(1, cache=cache)
    inputs = MorphInputs.of([ball(points=200), box()], ["a", "b"])
    steps = morph(inputs, path_blends(2, FRAMES), settings, computation=computation)
    return [step.payload for step in steps if step.payload]


if __name__ == "__main__":
    bake(FrameCache(Path(sys.argv[1])))
