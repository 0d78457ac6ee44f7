# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw what a guide changes into docs/pictures/guides.jpg: ``python3 run.py python docs/guides.py``.

A dog becomes a man, without a guide above, and with one on a front paw and a hand below.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from motions import Block, baked, drawn, save

from convwass_addon.applications.morphs.morph_settings import MorphSettings

# Unlike the add-on, the benchmarks are not installed.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from benchmarks.bipeds import MAN, Posture, biped
from benchmarks.coherence_guides import guides_at_tips
from benchmarks.coherence_pairs import Ends
from benchmarks.quadrupeds import DOG, STANDING, quadruped

# Light paths per pixel.
_SAMPLES = 12


def main() -> None:
    """Bake and render both rows."""
    dog, man = quadruped(DOG, STANDING, 22), biped(MAN, Posture(), 20)
    tips = np.array([[dog.fore[0][-1]], [man.arms[0][-1]]])
    ends = Ends(dog.sculpture.mesh(), man.sculpture.mesh(), tips=tips)
    rows = [
        baked((ends.first, ends.second), MorphSettings(resolution=100), guides_at_tips(ends, clicked))
        for clicked in ([], [(0, 0)])
    ]
    save(drawn(rows, Block("dog to man", ("no guide", "one guide")), _SAMPLES), "guides")


if __name__ == "__main__":
    main()
