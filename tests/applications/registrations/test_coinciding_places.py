# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest

from convwass_addon.applications.registrations.coinciding_places import coinciding_places
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from tests.shapes import ball, joined

BODY = ball(1.0, points=1200)
LEFT, RIGHT, UP = (ball(0.4, center, 400) for center in ((-1.8, 0.0, 0.0), (1.8, 0.0, 0.0), (0.0, 0.0, 2.2)))


def moved(mesh, offset, scale=1.0):
    return TriangleMesh(mesh.vertices * scale + offset, mesh.faces)


def test_coinciding_points_are_on_the_largest_common_part():
    """One of two balls next to a body has moved, and the other may have taken its place: pairs are on the body."""
    first, second = joined(BODY, LEFT, RIGHT), joined(BODY, LEFT, UP)
    pairs = coinciding_places(first, second)
    assert len(pairs) >= 6
    apart = np.linalg.norm(first.vertices[pairs[:, 0]] - second.vertices[pairs[:, 1]], axis=1)
    assert apart.max() < 1e-12
    assert (pairs < len(BODY.vertices)).all()


@pytest.mark.parametrize(("offset", "scale"), [((9.0, 2.0, -1.0), 1.0), ((0.0, 0.0, 0.0), 3.0)])
def test_shapes_apart_from_each_other_are_centered_first(offset, scale):
    first = joined(BODY, LEFT, RIGHT)
    pairs = coinciding_places(first, moved(first, np.array(offset), scale))
    assert len(pairs) >= 6
    assert np.array_equal(pairs[:, 0], pairs[:, 1])


def test_shapes_with_opposite_normals_do_not_coincide():
    """A ball and the same ball turned inside out."""
    assert coinciding_places(BODY, BODY.flipped()).shape == (0, 2)
