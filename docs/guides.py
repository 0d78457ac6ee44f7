# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw what a guide changes into docs/pictures/guides.jpg: ``python3 run.py python docs/guides.py``.

A man becomes an ogre who faces the other way: without a guide above, and with one on a hand below.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from motions import Block, baked, drawn, save

from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.geometry.mesh import TriangleMesh

# Unlike the add-on, the benchmarks are not installed.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from benchmarks.bipeds import MAN, OGRE, Posture, biped
from benchmarks.coherence_guides import guides_at_tips
from benchmarks.coherence_pairs import Ends

# Light paths per pixel.
_SAMPLES = 12


def main() -> None:
    """Bake and render both rows."""
    man, ogre = biped(MAN, Posture(), 20), biped(OGRE, Posture(), 21)
    half_turn = np.diag([-1.0, -1.0, 1.0])
    facing_away = ogre.sculpture.mesh()
    facing_away = TriangleMesh(facing_away.vertices @ half_turn, facing_away.faces)
    tips = np.array([[man.arms[0][-1]], [ogre.arms[0][-1] @ half_turn]])
    ends = Ends(man.sculpture.mesh(), facing_away, tips=tips)
    rows = [
        baked((ends.first, ends.second), MorphSettings(resolution=100), guides_at_tips(ends, clicked))
        for clicked in ([], [(0, 0)])
    ]
    save(drawn(rows, Block("man to ogre", ("no guide", "one guide")), _SAMPLES), "guides")


if __name__ == "__main__":
    main()
