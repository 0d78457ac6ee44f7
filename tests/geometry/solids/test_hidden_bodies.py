# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bodies inside others are hidden; those that reach out of them, or lie beside them, are not."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.solids.hidden_bodies import visible_triangles
from tests.shapes import ball, box, joined, with_faces


@pytest.mark.parametrize("inner", [box((0.3, 0.3, 0.3)), ball(0.4, points=60), box((0.5, 0.5, 0.5)).flipped()])
def test_what_is_inside_is_hidden(inner):
    found = visible_triangles(joined(inner, box(), box(center=(3.0, 0.0, 0.0))))
    np.testing.assert_array_equal(found, np.arange(len(found)) >= len(inner.faces))


@pytest.mark.parametrize(
    "other",
    [box((0.3, 0.3, 0.3), (0.4, 0.0, 0.0)), box((0.3, 0.3, 0.3), (2.0, 0.0, 0.0)), box((2.0, 0.5, 0.5)), box()],
    ids=["reaches out", "beside", "crosses", "coincides"],
)
def test_what_is_seen_is_not_hidden(other):
    assert visible_triangles(joined(other, box())).all()


def test_the_front_of_a_letter_that_shares_no_vertices_with_its_sides_is_seen():
    top = box().corners[:, :, 2].min(axis=1) > 0.0
    letter = joined(with_faces(box(), top), with_faces(box(), ~top))
    assert visible_triangles(letter).all()


def test_an_empty_mesh_has_no_bodies():
    assert visible_triangles(TriangleMesh(np.zeros((3, 3)), np.empty((0, 3), np.int64))).shape == (0,)
