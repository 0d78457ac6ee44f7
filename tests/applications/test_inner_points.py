# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Points inside bodies, behind points of their surface."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.skeletons.inner_points import InnerPointFinder
from convwass_addon.errors import InputError
from convwass_addon.geometry.solids.solid_angles import winding_numbers
from tests.shapes import ball, box, joined, square, torus


def test_inner_points_of_a_torus_lie_on_its_center_circle():
    found = InnerPointFinder(torus(1.0, 0.3)).find((1.3, 0.0, 0.0))
    assert np.linalg.norm(found.position - [1.0, 0.0, 0.0]) < 0.12
    assert found.depth == pytest.approx(0.3, abs=0.12)


def test_more_blur_goes_deeper():
    finder = InnerPointFinder(torus(1.0, 0.3))
    depths = [finder.find((1.3, 0.0, 0.0), depth).depth for depth in (0.4, 0.7, 1.0)]
    assert depths == sorted(depths) and depths[-1] > depths[0] + 0.05


@pytest.mark.parametrize("mesh", [ball(), torus(), box(size=(2.0, 1.0, 0.1))], ids=["ball", "torus", "board"])
def test_inner_points_of_all_vertices_are_inside(mesh):
    finder = InnerPointFinder(mesh)
    points = mesh.corners.mean(axis=1)[:: max(len(mesh.faces) // 12, 1)]
    found = np.array([finder.find(point).position for point in points])
    assert (winding_numbers(found, mesh) > 0.5).all()


def test_the_clicked_component_is_the_body():
    finder = InnerPointFinder(joined(box(), box(center=(3.0, 0.0, 0.0))))
    for x in (0.0, 3.0, 0.0):
        assert np.abs(finder.find((x, 0.5, 0.0)).position - [x, 0.1, 0.0]).max() < 0.4


def test_sheets_have_no_inside():
    with pytest.raises(InputError, match="encloses no volume"):
        InnerPointFinder(square()).find((0.0, 0.0, 0.0))
    with pytest.raises(InputError, match="depth"):
        InnerPointFinder(ball()).find((1.0, 0.0, 0.0), 0.0)
