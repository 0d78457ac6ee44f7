# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np

from convwass_addon.geometry.polygons import Polygons

# A cube, the first five of its faces as pairs with a common first diagonal; and a pair with another one.
FACES = np.array(
    [
        [(0, 1, 2), (0, 2, 3)],
        [(4, 7, 6), (4, 6, 5)],
        [(0, 4, 5), (0, 5, 1)],
        [(1, 5, 6), (1, 6, 2)],
        [(2, 6, 7), (2, 7, 3)],
        [(3, 7, 4), (0, 3, 4)],
    ]
).reshape(-1, 3)


def listed(polygons):
    return [tuple(face) for face in np.split(polygons.corners, polygons.starts[1:])]


def test_triangles_stay():
    assert listed(Polygons.of_triangles(FACES)) == [tuple(face) for face in FACES]


def test_pairs_become_quads_and_the_rest_comes_last():
    expected = [(0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4), (0, 3, 4)]
    assert listed(Polygons.of_quads(FACES)) == expected
    assert listed(Polygons.of_quads(FACES[:3])) == [(0, 1, 2, 3), (4, 7, 6)]
    # Pairs begin at even rows only.
    assert listed(Polygons.of_quads(FACES[1:5])) == [tuple(face) for face in FACES[1:5]]


def test_corners_tell_which_corners_of_triangles_they_are():
    for polygons in (Polygons.of_triangles(FACES), Polygons.of_quads(FACES)):
        np.testing.assert_array_equal(polygons.corners, FACES.ravel()[polygons.sources])
        assert len(np.unique(polygons.sources)) == len(polygons.corners)
