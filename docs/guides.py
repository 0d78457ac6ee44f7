# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw what a guide changes into docs/pictures/guides.jpg: ``python3 run.py python docs/guides.py``.

A dog becomes a man, without a guide above, and with one on a front paw and a hand below.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from motions import FRAMES, PICTURES, Block, labeled, rendered

from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.geometry.mesh import TriangleMesh

# Unlike the add-on, the benchmarks are not installed.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from benchmarks.bipeds import MAN, Posture, biped
from benchmarks.blends import baked_frames
from benchmarks.quadrupeds import DOG, STANDING, quadruped

# Pixels, quality of JPEG, and light paths per pixel.
_WIDTH, _QUALITY, _SAMPLES = 1370, 85, 12


def main() -> None:
    """Bake and render both rows."""
    dog, man = quadruped(DOG, STANDING, 22), biped(MAN, Posture(), 20)
    shapes = dog.sculpture.mesh(), man.sculpture.mesh()
    guide = {0: _nearest(shapes[0], dog.fore[0][-1]), 1: _nearest(shapes[1], man.arms[0][-1])}
    rows = []
    for guides in ([], [guide]):
        frames = baked_frames(shapes, FRAMES - 1, MorphSettings(resolution=100), guides)
        rows.append([shapes[frame.blend.source] if frame.mesh is None else frame.mesh for frame in frames])
    picture = labeled(rendered(rows, _WIDTH, _SAMPLES), Block("dog to man", ("no guide", "one guide")))
    picture.save(PICTURES / "guides.jpg", quality=_QUALITY, optimize=True, progressive=True)


def _nearest(mesh: TriangleMesh, place: np.ndarray) -> int:
    return int(np.linalg.norm(mesh.vertices - place, axis=1).argmin())


if __name__ == "__main__":
    main()
