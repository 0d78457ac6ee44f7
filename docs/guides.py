# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw what guides change into docs/pictures/guides.jpg: ``python3 run.py python docs/guides.py``.

A starfish becomes a hand, without guides above, and with two below: one arm is the thumb, and another one the little
finger.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from motions import Block, baked, drawn, save

from convwass_addon.applications.morphs.morph_settings import MorphSettings

# Unlike the add-on, the benchmarks are not installed.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from benchmarks.coherence_guides import guides_at_tips
from benchmarks.coherence_pairs import Ends, pairs_named

# Light paths per pixel.
_SAMPLES = 12
# Points next to the lower arms of the starfish, and to the thumb and the little finger.
_TIPS = np.array([[(-0.7, 0.0, 0.05), (0.7, 0.0, 0.05)], [(-0.83, -0.12, 0.95), (0.6, -0.07, 1.65)]])


def main() -> None:
    """Bake and render both rows."""
    (pair,) = pairs_named(["starfish to hand"], None)
    shapes = pair.ends()
    ends = Ends(shapes.first, shapes.second, tips=_TIPS)
    rows = [
        baked((ends.first, ends.second), MorphSettings(resolution=100), guides_at_tips(ends, clicked))
        for clicked in ([], [(0, 0), (1, 1)])
    ]
    save(drawn(rows, Block("starfish to hand", ("no guides", "two guides")), _SAMPLES), "guides")


if __name__ == "__main__":
    main()
