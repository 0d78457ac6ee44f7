# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Distances between a mesh and a surface, as far as they can be seen."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.visible_gap import VisibleGap
from tests.shapes import ball, box, joined


@pytest.mark.parametrize("radius", [0.9, 1.1])
def test_concentric_balls_are_apart_by_the_difference_of_their_radii(radius):
    found = VisibleGap.between(ball(radius), ball())
    assert found.mean == pytest.approx(0.1, rel=0.02) and found.most == pytest.approx(0.1, rel=0.02)
    assert found.outside == pytest.approx(0.1 if radius > 1.0 else 0.0, abs=2e-3)


def test_walls_inside_are_hidden_and_parts_outside_are_not():
    surface = ball()
    hidden = VisibleGap.between(joined(surface, ball(0.5)), surface)
    assert hidden.mean < 1e-9 and hidden.most < 1e-9
    seen = VisibleGap.between(joined(surface, box(center=(3.0, 0.0, 0.0))), surface)
    assert seen.most == pytest.approx(2.0, abs=0.7) and (seen.outside > 1.0).sum() == 8


def test_what_the_mesh_does_not_cover_is_seen():
    surface = ball()
    half = TriangleMesh(surface.vertices * np.where(surface.vertices[:, 2:] > 0.0, 1.0, [1.0, 1.0, 0.0]), surface.faces)
    # From the pole that is cut off to the flat face.
    assert VisibleGap.between(half, surface).most == pytest.approx(0.96, abs=0.03)
