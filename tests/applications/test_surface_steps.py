# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import pytest

from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph_problem import MorphFrame
from convwass_addon.applications.morphs.steady_topology import legs_of
from convwass_addon.applications.morphs.surface_steps import MeasuredSurface, SurfaceSteps, farthest
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from tests.shapes import ball, box, joined

BLENDS = path_blends(2, 12)
SMALL = ball(0.3, (2, 0, 0))


def chains_of(places, extra=(), shapes=None):
    """Return the chains of balls at positions along x, with a second ball in some blends."""
    steps = SurfaceSteps(legs_of(BLENDS), shapes)
    for index, (blend, x) in enumerate(zip(BLENDS, places, strict=True)):
        here = ball(1.0, (x, 0, 0))
        mesh = joined(here, ball(0.3, (x + 2.0, 0, 0))) if index in extra else here
        steps.add(MorphFrame(blend, None if blend.source is not None else mesh, {}))
    return steps.chains()


@pytest.mark.parametrize("measured", [MeasuredSurface.of_blend, MeasuredSurface.of_shape])
def test_distances_of_balls(measured):
    alone, moved, two = (measured(mesh) for mesh in (ball(), ball(1.0, (0.5, 0, 0)), joined(ball(), SMALL)))
    assert farthest(alone, moved) == pytest.approx(0.5, abs=0.05)
    assert farthest(alone, two) < 0.03
    assert farthest(two, alone) == pytest.approx(1.3, abs=0.05)


def test_shapes_of_few_triangles_are_measured_between_their_vertices():
    """A ball in the middle of a cube's face is far from all corners of the cube."""
    cube, pole = MeasuredSurface.of_shape(box()), ball(0.1, (0.0, 0.0, 0.5))
    assert farthest(MeasuredSurface.of_blend(pole), cube) == pytest.approx(0.1, abs=0.02)


@pytest.mark.parametrize("tip", [0, 777, 7777])
def test_a_single_vertex_that_sticks_out_is_found(tip):
    before = ball(points=8000)
    vertices = before.vertices.copy()
    vertices[tip] *= 1.2
    after = TriangleMesh(vertices, before.faces)
    measured = farthest(MeasuredSurface.of_blend(after), MeasuredSurface.of_blend(before))
    assert measured == pytest.approx(0.2, abs=0.01)


def test_even_steps_are_unchanged():
    assert chains_of([0.2 * i for i in range(13)]) == []


def test_appearing_parts_grow_afterwards_and_vanishing_parts_shrink_before():
    (grows,) = chains_of([0.2 * i for i in range(13)], extra=range(4, 13))
    assert (grows.beside, grows.blends) == (BLENDS[3], tuple(BLENDS[4:12]))
    assert len(grows.near.mesh.vertices) == len(ball().vertices)
    # In the eight remaining steps the small ball moves by 1.3 and seven times 0.2.
    assert grows.reach == pytest.approx(2.7 / 8, abs=0.03)
    (shrinks,) = chains_of([0.2 * i for i in range(13)], extra=range(9))
    assert (shrinks.beside, shrinks.blends) == (BLENDS[9], tuple(BLENDS[8:0:-1]))
    assert len(shrinks.near.mesh.vertices) == len(ball().vertices)


def test_a_part_in_one_blend_grows_and_shrinks():
    grows, shrinks = chains_of([0.2 * i for i in range(13)], extra=[4])
    assert (grows.blends[0], shrinks.blends[0]) == (BLENDS[4], BLENDS[4])


@pytest.mark.parametrize("end", [0, 12])
def test_what_appears_beside_a_shape_grows_in_the_blends_next_to_it(end):
    """A shape without the small ball that all blends have, or with one that none has: the blends close to it change."""
    moved = ball(1.0, (0.2 * end, 0, 0))
    with_small = joined(moved, ball(0.3, (0.2 * end + 2.0, 0, 0)))
    inward = BLENDS[1:-1] if end == 0 else BLENDS[-2:0:-1]
    for shape, extra in ((moved, range(13)), (with_small, ())):
        (chain,) = chains_of([0.2 * i for i in range(13)], extra, {BLENDS[end]: shape})
        assert (chain.beside, chain.blends) == (BLENDS[end], tuple(inward))
        assert chain.near.mesh.volume == pytest.approx(shape.volume)
        # In the eleven steps, the small ball moves by 1.3 and ten times 0.2.
        assert chain.reach == pytest.approx(3.3 / 11, abs=0.03)


def test_shapes_next_to_even_steps_change_nothing():
    shapes = {BLENDS[0]: ball(), BLENDS[-1]: ball(1.0, (2.4, 0, 0))}
    assert chains_of([0.2 * i for i in range(13)], (), shapes) == []


def test_long_steps_are_found_if_the_leg_begins_with_longer_ones():
    """The usual step is known only at the end of the leg."""
    chains = chains_of([0.0, 0.1, 2.1, 4.1, 6.1, 8.1, 9.3, *(9.3 + 0.1 * i for i in range(1, 7))])
    assert {chain.beside for chain in chains} >= {BLENDS[1], BLENDS[5]}


def test_of_chains_that_go_the_same_way_the_first_one_comes_first():
    """Later ones start from a surface that the first one may change."""
    places = [0.0, 1.0, 3.5, 5.0, *(5.0 + 0.1 * i for i in range(1, 10))]
    chains = chains_of(places, (), {BLENDS[0]: ball()})
    onwards = [chain.beside for chain in chains if chain.blends[-1] == BLENDS[11]]
    back = [chain.beside for chain in chains if chain.blends[-1] == BLENDS[1]]
    assert onwards == BLENDS[:3]
    assert back == [BLENDS[3], BLENDS[2]]
    assert [chain.beside for chain in chains] == [BLENDS[0], BLENDS[3], BLENDS[1], BLENDS[2], BLENDS[2]]
