# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.soft_maps.guessed_pairs import guessed_pairs
from convwass_addon.applications.soft_maps.map_pieces import faces_of, matched_pieces, part_of
from convwass_addon.applications.soft_maps.map_sides import MapSide
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from tests.applications.maps import exact_map, turn, without_points
from tests.shapes import ball, box, joined, torus

NO_PAIRS = np.empty((0, 2), np.int64)


def side(*meshes):
    return MapSide(joined(*meshes), "Pet")


def ranges(matches):
    return {(int(m.source[0]), int(m.source[-1]), int(m.target[0]), int(m.target[-1])) for m in matches}


def test_components_are_matched_by_shape_and_place():
    body, eyes = ball(points=300), [ball(0.1, (x, 1.0, 0.5), 60) for x in (-0.3, 0.3)]
    source, target = side(body, *eyes), side(eyes[1], body, eyes[0])
    matches = matched_pieces(source, target, NO_PAIRS)
    # The largest comes first.
    assert len(matches[0].source) == 300
    assert ranges(matches) == {(0, 299, 60, 359), (300, 359, 360, 419), (360, 419, 0, 59)}


def test_pairs_override_shape_and_can_join_several_components():
    one, other = ball(points=100), torus(center=(4, 0, 0), segments=(12, 8))
    source, target = side(one, other), side(other, one)
    (match,) = matched_pieces(source, side(joined(one, other)), np.array([(0, 0), (5, 150), (120, 7)]))
    assert len(match.source) == len(match.target) == 196 and len(match.pairs) == 3
    crossed = matched_pieces(source, target, np.array([(0, 3)]))
    assert ranges(crossed) == {(0, 99, 0, 95), (100, 195, 96, 195)}


def test_a_component_without_a_similar_one_has_no_counterpart():
    matches = matched_pieces(side(ball(points=100), ball(0.001, (9, 9, 9), 40)), side(ball(points=90)), NO_PAIRS)
    assert ranges(matches) == {(0, 99, 0, 89)}


def test_a_component_gets_only_its_own_faces_and_weights():
    whole = MapSide(joined(box(), ball(points=50), box(center=(5, 0, 0))), "Pet", {"Fur": np.arange(66.0)})
    vertices = np.r_[0:8, 58:66]
    part = part_of(whole, vertices)
    np.testing.assert_array_equal(part.mesh.corners, whole.mesh.corners[faces_of(whole.mesh, vertices)])
    np.testing.assert_array_equal(part.groups["Fur"], vertices)
    assert part_of(whole, np.arange(66)) is whole


@pytest.mark.parametrize("scale", [1.0, 2.5])
def test_an_eye_rotates_with_the_surrounding_head(scale):
    """An eye is a ball or a box, so only its surroundings determine its rotation."""
    rotation = turn((70, 20, -110))
    source = side(ball(points=400), ball(0.1, (0, 1, 0.5), 80))
    target = MapSide(TriangleMesh(scale * source.mesh.vertices @ rotation.T + 4.0, source.mesh.faces), "Dog")
    known = without_points(exact_map(target.mesh.vertices, target.mesh), np.arange(480) >= 400)
    matches = matched_pieces(source, target, np.array([(0, 0)]))
    pairs = guessed_pairs(source, target, matches[1], known)
    assert len(pairs) == 8
    np.testing.assert_array_equal(pairs[:, 0], pairs[:, 1])
    assert (pairs >= 400).all()
    nothing = without_points(known, np.ones(480, bool))
    assert not len(guessed_pairs(source, target, matches[1], nothing))
