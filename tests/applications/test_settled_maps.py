# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.soft_maps.settled_maps import settled
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import UNINTERRUPTED
from tests.applications.maps import turn
from tests.shapes import ball

# An egg with three different axes and a nose: it has no symmetries.
_BALL = ball(points=500).vertices
_NOSE = 1.0 + 0.8 * np.exp(-np.square(_BALL - [0.8, 0.5, 0.33]).sum(axis=1) / 0.1)[:, None]
EGG = TriangleMesh(_BALL * _NOSE * [2.0, 1.0, 0.7], ball(points=500).faces)
NO_PAIRS = np.empty((0, 2), np.int64)


@pytest.mark.parametrize("is_mirrored", [False, True])
def test_a_map_that_misses_the_ends_is_stretched_back_to_them(is_mirrored):
    flip = np.array([1.0, 1.0, -1.0 if is_mirrored else 1.0])
    vertices = 3.0 * (EGG.vertices * flip) @ turn().T + [5, 6, 7]
    surface = TriangleMesh(vertices, EGG.faces[:, ::-1].copy() if is_mirrored else EGG.faces)
    middle = surface.vertices.mean(axis=0)
    shrunk = middle + 0.8 * (surface.vertices - middle)
    found = settled(EGG, surface, shrunk, NO_PAIRS, is_mirrored, UNINTERRUPTED)
    before = np.linalg.norm(shrunk - vertices, axis=1).mean()
    after = np.linalg.norm(found - vertices, axis=1).mean()
    assert after < 0.15 * before
