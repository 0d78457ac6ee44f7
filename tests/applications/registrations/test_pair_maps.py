# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Maps between two shapes that prefer the same heights where others are doubtful."""

from functools import cache

import numpy as np
import pytest

from assets.sculpting import ellipsoid, frustum, tube
from benchmarks.sculptures import Sculpture
from convwass_addon.applications.registrations import pair_maps
from convwass_addon.applications.registrations.carriers import carrier_of
from convwass_addon.applications.registrations.mirrored_sides import MirroredSides, height_groups
from convwass_addon.applications.registrations.pair_maps import PairMap, pair_map
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import UNINTERRUPTED, drained
from tests.grids import figure
from tests.shapes import ball

NO_PAIRS = np.empty((0, 2), np.int64)
BRANCHES = ((0.3, 0.5, 0.9), (2.2, 0.45, 0.95), (4.1, 0.48, 0.85), (5.4, 0.4, 1.05), (1.2, 0.3, 1.2))


@cache
def tree():
    """A trunk and five branches, each with leaves at its end; not symmetric."""
    clay = Sculpture(5)
    clay.add(tube([(0, 0, 0), (0.02, 0, 0.5), (0, 0, 0.95)], [0.14, 0.1, 0.09], 4))
    for angle, length, height in BRANCHES:
        end = (np.cos(angle) * length, np.sin(angle) * length, height + 0.45)
        clay.add(tube([(0, 0, height - 0.1), end], [0.07, 0.05], 1), 0.04)
        clay.add(ellipsoid(end, (0.26, 0.26, 0.2)), 0.05)
    return clay.mesh()


@cache
def snowman():
    """Three balls on top of each other, two arms, and a hat."""
    clay = Sculpture(6)
    for height, radius in ((0.4, 0.42), (0.95, 0.3), (1.35, 0.2)):
        clay.add(ellipsoid((0, 0, height), (radius, radius, 0.95 * radius)), 0.04)
    for side in (-1, 1):
        clay.add(tube([(0, 0.25 * side, 1.0), (0, 0.7 * side, 1.25)], [0.04, 0.035], 1), 0.02)
    clay.add(frustum((0, 0, 1.48), (0, 0, 1.8), (0.16, 0.16), 0.03), 0.02)
    return clay.mesh()


def test_heights_rise_from_the_lowest_vertex_to_half():
    mesh = ball(points=200)
    loose = TriangleMesh(np.concatenate([mesh.vertices + 7.0, [[0.0, 0.0, 99.0], [0.0, 0.0, -99.0]]]), mesh.faces)
    up = height_groups(loose)["up"]
    z = mesh.vertices[:, 2]
    np.testing.assert_allclose(up[:-2], 0.5 * (z - z.min()) / np.ptp(z), atol=1e-12)
    assert up[-2:].tolist() == [0.5, 0.0]


def test_a_doubtful_map_stands_upright():
    first, second = (carrier_of(mesh, name, 500, UNINTERRUPTED) for mesh, name in ((tree(), "t"), (snowman(), "s")))
    assert MirroredSides.of(first.mesh, second.mesh) is None
    found = drained(pair_map(first, second, NO_PAIRS, 300, UNINTERRUPTED))
    z = first.mesh.vertices[:, 2]
    low = found.found.forward.found & (z < z.min() + 0.15 * np.ptp(z))
    there = found.found.forward.positions(second.mesh)[low, 2] - second.mesh.vertices[:, 2].min()
    assert np.mean(there < 0.5 * np.ptp(second.mesh.vertices[:, 2])) > 0.9


@pytest.mark.parametrize(
    ("plain", "upright", "taken"), [(0.3, 0.26, "upright"), (0.3, 0.25, "plain"), (0.5, 0.6, "plain")]
)
def test_of_two_doubtful_maps_the_upright_one_is_taken(monkeypatch, plain, upright, taken):
    """Unless it is clearly worse; maps that are fair are not solved again."""
    scores = {"plain": plain, "upright": upright}
    weights = []

    def solved(_shapes, pairs, groups=None, _mirrors=None, weight=None):
        yield from ()
        weights.append(weight)
        return PairMap(
            "plain" if groups is None else "upright", pairs, scores["plain" if groups is None else "upright"]
        )

    monkeypatch.setattr(pair_maps, "_solved", solved)
    carriers = [carrier_of(mesh, "shape", 1000, UNINTERRUPTED) for mesh in (tree(), snowman())]
    found = drained(pair_map(*carriers, NO_PAIRS, 1000, UNINTERRUPTED))
    assert (found.found, found.score) == (taken, scores[taken])
    assert len(weights) == (1 if plain == 0.5 else 2)


@pytest.mark.parametrize(
    ("missed", "followed"), [((0.1, 0.1), [0, 1]), ((0.1, 0.9), [0]), ((0.9, 0.9), [])], ids=["both", "one", "none"]
)
def test_the_map_without_guides_follows_those_that_it_does_not_contradict(monkeypatch, missed, followed):
    """It is better than with guides, however many of them are left out."""
    pairs = np.array([(1, 2), (3, 4)])

    def of_pairs(_shapes, given, *_others):
        yield from ()
        return PairMap("found", given, 0.3 if len(given) else 0.8)

    monkeypatch.setattr(pair_maps, "_solved", of_pairs)
    monkeypatch.setattr(pair_maps, "_missed", lambda *_arguments: np.array(missed))
    monkeypatch.setattr(pair_maps, "coinciding_places", lambda *_meshes: NO_PAIRS)
    carriers = [carrier_of(mesh, "shape", 1000, UNINTERRUPTED) for mesh in (tree(), snowman())]
    found = drained(pair_map(*carriers, pairs, 1000, UNINTERRUPTED))
    assert found.score == 0.8
    np.testing.assert_array_equal(found.pairs, pairs[followed])


@pytest.mark.parametrize(
    ("sided", "free", "expected", "count"), [(0.3, 0.6, 0.6, 2), (0.6, 0.3, 0.6, 2), (0.95, 0.97, 0.95, 1)]
)
def test_guides_may_contradict_the_heights_or_sides_of_a_body(monkeypatch, sided, free, expected, count):
    """So the map is also solved without them, unless it leaves no doubt with them."""
    pairs = np.array([(1, 2)])
    scores = []

    def solved(_shapes, given, groups=None, *_others):
        yield from ()
        if len(given):
            scores.append(free if groups is None else sided)
        return PairMap("found", given, scores[-1] if len(given) else 0.0)

    monkeypatch.setattr(pair_maps, "_solved", solved)
    monkeypatch.setattr(pair_maps, "_missed", lambda *_arguments: np.zeros(1))
    monkeypatch.setattr(pair_maps, "coinciding_places", lambda *_meshes: NO_PAIRS)
    carriers = [carrier_of(figure(10)[0], "figure", 5000, UNINTERRUPTED) for _ in range(2)]
    sides = MirroredSides.of(*(own.mesh for own in carriers))
    found = drained(pair_map(*carriers, pairs, 1000, UNINTERRUPTED, sides))
    assert (found.score, len(scores)) == (expected, count)


def tried_with(monkeypatch, scores, missed=(), around=(), seeds=NO_PAIRS):
    """Let maps have scores by the first vertices of their pairs; return those that are asked for."""
    asked = []

    def solved(_shapes, given, groups=None, *_others, weight=None):
        yield from ()
        asked.append("upright" if weight else tuple(given[:, 0].tolist()))
        return PairMap(asked[-1], given, scores[asked[-1]])

    def confidences(_first, _second, _found, chosen):
        return np.array([around[place - 1] for place in chosen[:, 0]])

    monkeypatch.setattr(pair_maps, "_solved", solved)
    monkeypatch.setattr(pair_maps, "_missed", lambda *_arguments: np.array(missed))
    monkeypatch.setattr(pair_maps, "_confidence_around", confidences)
    monkeypatch.setattr(pair_maps, "coinciding_places", lambda *_meshes: seeds)
    return asked


GUIDES = np.array([(1, 5), (2, 6), (3, 7)])


@pytest.mark.parametrize(
    ("missed", "scores", "asked"),
    [
        ((0.1, 0.1, 0.9), {(1, 2, 3): 0.73}, [(1, 2, 3)]),
        ((0.1, 0.1, 0.9), {(1, 2, 3): 0.71, (1, 2): 0.73}, [(1, 2, 3), (1, 2)]),
        ((0.1, 0.9, 0.9), {(1, 2, 3): 0.71, (1, 3): 0.73}, [(1, 2, 3), (1, 3)]),
    ],
    ids=["all are good", "most agree with the plain map", "the one with the lowest confidence is wrong"],
)
def test_guides_are_left_out_until_the_map_is_hardly_worse_than_the_plain_one(monkeypatch, missed, scores, asked):
    found = tried_with(monkeypatch, {(): 0.8, **scores}, missed, around=(0.5, 0.1, 0.9))
    carriers = [carrier_of(mesh, "shape", 1000, UNINTERRUPTED) for mesh in (tree(), snowman())]
    chosen = drained(pair_map(*carriers, GUIDES, 1000, UNINTERRUPTED))
    assert found == [(), *asked]
    np.testing.assert_array_equal(chosen.pairs, GUIDES[[place - 1 for place in asked[-1]]])


@pytest.mark.parametrize(
    ("with_seeds", "without", "upright", "taken"),
    [
        (0.6, 0.9, 0.9, (4,)),
        (0.1, 0.6, 0.9, ()),
        (0.1, 0.4, 0.33, ()),
        (0.1, 0.4, 0.35, "upright"),
        (0.3, 0.9, 0.25, (4,)),
    ],
)
def test_points_that_coincide_need_not_correspond(monkeypatch, with_seeds, without, upright, taken):
    """If there is no good map with them, one without them is tried, and then an upright one."""
    tried_with(monkeypatch, {(4,): with_seeds, (): without, "upright": upright}, seeds=np.array([(4, 4)]))
    carriers = [carrier_of(mesh, "shape", 1000, UNINTERRUPTED) for mesh in (tree(), snowman())]
    assert drained(pair_map(*carriers, NO_PAIRS, 1000, UNINTERRUPTED)).found == taken
