# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Soft maps from two meshes and pairs to points for all vertices, on meshes with known correspondence."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from convwass_addon.applications.soft_maps.map_extension import DOUBTFUL
from convwass_addon.applications.soft_maps.map_sides import MapSide
from convwass_addon.applications.soft_maps.map_solving import soft_map_steps
from convwass_addon.applications.soft_maps.soft_map_settings import SoftMapSettings
from convwass_addon.applications.soft_maps.surface_maps import distribution_of
from convwass_addon.errors import Cancelled, InputError
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from tests.applications.maps import arm, subdivided, tube, turn
from tests.applications.test_densities_on_animals import horse
from tests.controls import CountingControl, recorded
from tests.shapes import ball, joined, shuffled, torus, with_faces

QUICK = SoftMapSettings(vertices=200, sweeps=4)


def solved(source, target, pairs, settings=QUICK, **groups):
    """Return the map after checking the progress reports."""
    sides = (MapSide(source, "Fox", groups.get("here", {})), MapSide(target, "Dog", groups.get("there", {})))
    solving = recorded(soft_map_steps(*sides, pairs, settings))
    fractions = [step.fraction for step in solving.reports]
    assert fractions == sorted(fractions) and fractions[0] == 0.0 and fractions[-1] == 1.0
    found = solving.result
    json.dumps(found.record)
    for points, own, other in ((found.forward, source, target), (found.backward, target, source)):
        assert len(points) == len(own.vertices)
        assert points.faces.max() < len(other.faces)
        assert points.barycentric.min() >= 0
        np.testing.assert_allclose(points.barycentric.sum(axis=1), points.found, atol=1e-5)
        assert (points.confidence >= 0).all() and (points.confidence <= 1).all()
        assert not points.confidence[~points.found].any()
        assert np.isinf(points.spread[~points.found]).all() and np.isfinite(points.spread[points.found]).all()
    return found


def ends(mesh, count):
    """Vertices far from each other."""
    chosen = [int(np.linalg.norm(mesh.vertices - mesh.vertices.mean(axis=0), axis=1).argmax())]
    while len(chosen) < count:
        apart = np.linalg.norm(mesh.vertices[:, None] - mesh.vertices[chosen], axis=2).min(axis=1)
        chosen.append(int(apart.argmax()))
    return np.array(chosen)


def errors(points, other, truth):
    """Distances from the true points, relative to the size of the other surface."""
    return np.linalg.norm(points.positions(other) - truth, axis=1) / other.root_area


@cache
def posed_horse():
    """The horse, bent, rotated and reordered; the map between the two; the new index of every vertex."""
    source = horse()
    x, y, z = (source.vertices - source.vertices.mean(axis=0)).T
    along = y if np.ptp(y) > np.ptp(x) else x
    across = x if np.ptp(y) > np.ptp(x) else y
    radius = 1.5 * np.ptp(along)
    bent = np.stack(
        [(radius - across) * np.sin(along / radius), radius - (radius - across) * np.cos(along / radius), z], 1
    )
    target, place = shuffled(TriangleMesh(bent @ turn().T + 3.0, source.faces))
    chosen = ends(source, 6)
    return source, target, place, chosen, solved(source, target, np.stack([chosen, place[chosen]], axis=1))


def test_a_posed_copy_is_found_again_both_ways():
    source, target, place, chosen, found = posed_horse()
    forward = errors(found.forward, target, target.vertices[place])
    backward = errors(found.backward, source, source.vertices[np.argsort(place)])
    # A third of an edge of the coarse meshes.
    assert forward.mean() < 0.035 and (forward < 0.1).mean() > 0.97
    assert backward.mean() < 0.035 and (backward < 0.1).mean() > 0.97
    # Pairs are exact.
    assert forward[chosen].max() < 1e-6
    assert backward[place[chosen]].max() < 1e-6
    assert not found.notices
    assert found.record["pairs"] == 6
    (part,) = found.record["parts"]
    assert 200 <= part["source_vertices"] < 400 and part["sweeps"] >= 4


def test_confidence_is_lower_where_the_error_is_larger():
    """Two swapped pairs spoil the map only around them."""
    source, target, place, chosen, good = posed_horse()
    pairs = np.stack([chosen, place[chosen]], axis=1)
    pairs[:2, 1] = pairs[1::-1, 1]
    found = solved(source, target, pairs)
    error, confidence = errors(found.forward, target, target.vertices[place]), found.forward.confidence
    assert confidence.mean() < good.forward.confidence.mean() - 0.2
    doubtful = confidence < np.quantile(confidence, 0.3)
    assert error[doubtful].mean() > 3.0 * error[~doubtful].mean()
    assert any("is mapped with little confidence" in str(notice) for notice in found.notices)


def test_a_blurred_map_is_not_a_doubtful_map():
    """With all of its blur, the map is as accurate as the sharp one, and as confident."""
    source, target, place, chosen, sharp = posed_horse()
    pairs = np.stack([chosen, place[chosen]], axis=1)
    truth = target.vertices[place]
    soft = solved(source, target, pairs, replace(QUICK, sharpness=0.0))
    assert np.median(soft.forward.spread) > 3.0 * np.median(sharp.forward.spread)
    assert errors(soft.forward, target, truth).mean() < 1.5 * errors(sharp.forward, target, truth).mean()
    assert (soft.forward.confidence < DOUBTFUL).mean() < 0.05
    assert not soft.notices


def test_a_wrong_blurred_map_is_doubtful():
    source, target, place, chosen, _ = posed_horse()
    pairs = np.stack([chosen, place[chosen]], axis=1)
    pairs[:2, 1] = pairs[1::-1, 1]
    found = solved(source, target, pairs, replace(QUICK, sharpness=0.0))
    error, doubtful = errors(found.forward, target, target.vertices[place]), found.forward.confidence < DOUBTFUL
    assert 0.2 < doubtful.mean() < 0.7
    assert error[doubtful].mean() > 3.0 * error[~doubtful].mean()
    assert any("is mapped with little confidence" in str(notice) for notice in found.notices)


def test_the_distribution_of_a_vertex_lies_around_its_point():
    _, target, _, chosen, found = posed_horse()
    areas = target.vertex_areas / target.area
    positions = found.forward.positions(target)
    for vertex in (0, 1234, int(chosen[0])):
        density = distribution_of(found, vertex)
        assert density.min() >= 0
        assert density @ areas == pytest.approx(1.0, abs=1e-4)
        middle = (density * areas) @ target.vertices
        assert np.linalg.norm(middle - positions[vertex]) < 0.06 * target.root_area
    with pytest.raises(InputError, match="no vertex 99999"):
        distribution_of(found, 99999)


@pytest.mark.parametrize("is_source_finer", [False, True])
def test_one_mesh_may_be_much_finer(is_source_finer):
    coarse = horse()
    fine = subdivided(subdivided(coarse))
    chosen = ends(coarse, 6)
    source, target = (fine, coarse) if is_source_finer else (coarse, fine)
    found = solved(source, target, np.stack([chosen, chosen], axis=1))
    assert errors(found.forward, target, source.vertices).mean() < 0.035
    assert errors(found.backward, source, target.vertices).mean() < 0.035


def test_components_are_matched_by_pairs_and_the_others_by_shape():
    big, small, ring = ball(1.0, (0, 0, 0), 700), ball(0.3, (3, 0, 0), 200), torus(1, 0.3, (0, 5, 0), (24, 12))
    source = joined(big, small, ring)
    # Reordered and rotated: the ring is recognized by shape, and the pairs tell the balls apart.
    target = joined(ring, ball(1.0, (3, 0, 0), 600), ball(0.3, (0, 0, 0), 220))
    starts, others = np.cumsum([0, 700, 200]), np.cumsum([0, 288, 600])
    pairs = [(starts[0] + 10, others[1] + 10), (starts[0] + 600, others[1] + 500), (starts[1] + 5, others[2] + 5)]
    found = solved(source, target, np.array(pairs))
    labels = np.repeat([0, 1, 2], [288, 600, 220])
    reached = labels[target.faces[found.forward.faces][:, 0]]
    np.testing.assert_array_equal(reached, np.repeat([1, 2, 0], [700, 200, 288]))
    areas = target.vertex_areas / target.area
    # The whole row of a small component lies on its counterpart.
    density = distribution_of(found, 800)
    assert density @ areas == pytest.approx(1.0, abs=1e-4)
    assert not density[: others[2]].any()
    assert len(found.record["parts"]) == 3


def test_a_component_without_a_counterpart_has_no_points_and_is_reported():
    source = joined(torus(segments=(36, 18)), ball(0.2, (0, 0, 3), 100))
    target = torus(segments=(36, 18))
    chosen = np.array([0, 200, 400, 600])
    found = solved(source, target, np.stack([chosen, chosen], axis=1))
    assert found.forward.found[:648].all() and not found.forward.found[648:].any()
    assert found.backward.found.all()
    assert not distribution_of(found, 700).any()
    assert [str(notice) for notice in found.notices] == [
        "100 vertices of Fox have no counterpart: mark a pair on each of their pieces."
    ]


def test_without_pairs_there_is_a_result_and_a_warning():
    found = solved(arm(0.7)[0], arm()[0], [])
    assert found.forward.found.all()
    assert [str(notice) for notice in found.notices] == [
        "Without pairs left and right cannot be told apart; mark two or three, off the middle."
    ]


def test_another_genus_and_open_meshes_have_a_result():
    ring = torus(segments=(36, 18))
    found = solved(ring, ball(points=600), [(0, 0), (9 * 18, 300)])
    assert found.forward.found.all() and found.backward.found.all()
    open_tube, _, _ = tube(30, 15)
    half = with_faces(ring, ring.corners.mean(axis=1)[:, 0] > 0)
    found = solved(open_tube, half, [(0, 9)])
    assert found.forward.found.all()
    np.testing.assert_array_equal(found.backward.found, np.isin(np.arange(len(half.vertices)), half.faces))


def test_a_pair_that_contradicts_the_others_is_reported():
    mesh, _ = arm()
    chosen = np.array([0, 8, 160, 320, 480, 632])
    pairs = np.stack([chosen, chosen], axis=1)
    pairs[0, 1] = 630
    found = solved(mesh, mesh, pairs)
    assert "vertex 0 and vertex 630 contradicts the others" in str(found.notices[0])


def test_the_work_can_be_cancelled():
    control = CountingControl(last=4)
    mesh, _ = arm()
    with pytest.raises(Cancelled):
        list(soft_map_steps(MapSide(mesh, "A"), MapSide(mesh, "B"), [], QUICK, control))
    # Both sides are coarsened in parallel, and each thread ends at its next check.
    assert 4 <= control.count <= 5


@pytest.mark.parametrize(
    ("pairs", "message"),
    [
        ([(0, 99999)], "no vertex 99999; Dog has 642"),
        ([(-1, 3)], "no vertex -1; Fox has"),
        ([(642, 0)], "Vertex 642 of Fox belongs to no face"),
        ([(0, 1), (0, 2)], "Vertex 0 of Fox is in 2 pairs"),
        ([(0, 1), (2, 1), (3, 1)], "Vertex 1 of Dog is in 3 pairs"),
        ([(0.5, 1)], "two vertex numbers"),
        ([1, 2, 3], "two vertex numbers"),
    ],
)
def test_invalid_pairs_are_refused(pairs, message):
    mesh, _ = arm()
    loose = TriangleMesh(np.concatenate([mesh.vertices, [[9, 9, 9]]]), mesh.faces)
    with pytest.raises(InputError, match=message):
        list(soft_map_steps(MapSide(loose, "Fox"), MapSide(mesh, "Dog"), pairs, QUICK))


def test_duplicate_pairs_count_once():
    mesh, _ = arm()
    found = solved(mesh, mesh, [(0, 0), (0, 0), (632, 632)])
    assert found.record["pairs"] == 2


def test_meshes_without_a_surface_and_groups_of_another_size_are_refused():
    mesh, _ = arm()
    flat = TriangleMesh(np.zeros((3, 3)), np.array([[0, 1, 2]]))
    with pytest.raises(InputError, match="Flat has no faces with an area"):
        list(soft_map_steps(MapSide(mesh, "Arm"), MapSide(flat, "Flat"), []))
    with pytest.raises(InputError, match="The group Fur must have"):
        list(soft_map_steps(MapSide(mesh, "Arm", {"Fur": np.ones(4)}), MapSide(mesh, "B"), []))
    far = joined(arm()[0], TriangleMesh(1e-9 * torus(segments=(9, 6)).vertices, torus(segments=(9, 6)).faces))
    assert solved(far, mesh, []).forward.found[: len(mesh.vertices)].all()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"vertices": 10}, "between 50 and 4000"),
        ({"vertices": 100.5}, "Vertices must be a whole number"),
        ({"sweeps": 0}, "Sweeps"),
        ({"tau": -1}, "Tau"),
        ({"tau": float("nan")}, "Tau"),
        ({"sharpness": 2}, "Sharpness"),
        ({"gamma_scale": 0}, "Blur"),
        ({"group_weight": -1}, "Weight of Groups"),
    ],
)
def test_invalid_settings_are_refused(change, message):
    with pytest.raises(InputError, match=message):
        SoftMapSettings(**change)
