# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import pickle
from itertools import pairwise

import numpy as np
import pytest

from convwass_addon.applications.motions.remaining_distance import remaining_share
from convwass_addon.applications.motions.warp_motion import WarpEffort, warp_motion
from convwass_addon.errors import Cancelled, InputError
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import Control, Progress, drained
from tests.shapes import ball, box, joined, square, torus, with_faces

LONG, TALL = box((3.0, 1.0, 1.0)), box((1.0, 1.2, 2.5), center=(5.0, 1.0, 0.0))
EFFORT, LEAST = WarpEffort(cells=24, rounds=8), WarpEffort(cells=24, rounds=3)
CROSS = joined(box((2.5, 0.6, 0.7)), box((0.7, 0.6, 2.5)))


def warp(shapes, pairs=((0, 1),), coherence=0.5, effort=EFFORT):
    return drained(warp_motion(shapes, [f"shape {i}" for i in range(len(shapes))], pairs, coherence, Control(), effort))


@pytest.fixture(scope="module")
def pair():
    return warp([LONG, TALL])


@pytest.fixture(scope="module")
def three():
    return warp([LONG, TALL, CROSS], [(0, 1), (0, 2), (1, 2)])


def spread(first, second):
    """Largest distance between vertices of two moves of one motion."""
    return max(
        np.abs(a.vertices - b.vertices).max()
        for a, b in zip(first, second, strict=True)
        if a is not None and b is not None
    )


def test_equal_balls_are_translated():
    offset = np.array([7.0, -3.0, 2.0])
    motion = warp([ball(points=300), ball(points=300, center=offset)])
    for t in (0.2, 0.5):
        there, back = motion.moved((1.0 - t, t))
        np.testing.assert_allclose(there.vertices, there.rest.vertices + t * offset, atol=0.02)
        np.testing.assert_allclose(back.vertices, back.rest.vertices - (1.0 - t) * offset, atol=0.02)


def test_a_ball_grows_to_a_larger_one():
    """A similarity: halfway, both have the mean radius."""
    small, large = ball(points=300), ball(points=300, radius=3.0, center=(5.0, 0.0, 0.0))
    motion = warp([small, large])
    for t in (0.25, 0.5):
        middle = t * motion.lattice.centers[1] + (1.0 - t) * motion.lattice.centers[0]
        for shape in motion.moved((1.0 - t, t)):
            radii = np.linalg.norm(shape.vertices - middle, axis=1)
            np.testing.assert_allclose(radii, 1.0 + 2.0 * t, rtol=0.03)
    apart = motion.with_coherence(0.0).moved((0.5, 0.5))
    assert [np.ptp(shape.vertices, axis=0).max() for shape in apart] == pytest.approx([2.0, 6.0], rel=0.02)


def test_solids_that_fill_the_grid_get_fewer_cells():
    first, second = (ball(points=300, radius=radius) for radius in (1.0, 0.9))
    motion = warp([first, second], effort=WarpEffort(cells=48, rounds=2, filled=3000))
    assert 1000 < first.volume / motion.lattice.spacing**3 <= 3000
    assert warp([first, second], effort=WarpEffort(cells=24, rounds=2, filled=3000)).lattice.shape == (24, 24, 24)


def test_ends_are_the_shapes_themselves(pair):
    first, nothing = pair.moved((1.0, 0.0))
    assert nothing is None
    np.testing.assert_array_equal(first.vertices, first.rest.vertices)
    np.testing.assert_array_equal(first.rest.vertices[: len(LONG.vertices)], LONG.vertices)
    near = pair.moved((1.0 - 1e-6, 1e-6))[0]
    np.testing.assert_allclose(near.vertices, first.vertices, atol=1e-4)
    assert pair.moved((0.0, 1.0))[0] is None


def test_the_shapes_come_to_coincide(pair):
    assert remaining_share(pair, [LONG, TALL]) < 0.15
    first, second = pair.moved((0.5, 0.5))
    np.testing.assert_allclose(first.mesh.bounds, second.mesh.bounds, atol=0.2)
    assert 0.8 < first.mesh.volume / LONG.volume < 1.25


def test_swapped_shapes_move_alike(pair):
    swapped = warp([TALL, LONG])
    for t in (0.25, 0.5):
        assert spread(pair.moved((1.0 - t, t)), swapped.moved((t, 1.0 - t))[::-1]) < 1e-3


def test_coherence_is_a_dial(pair):
    weights = (0.4, 0.6)
    steps = np.linspace(0.0, 1.0, 21)
    moves = [pair.with_coherence(float(c)).moved(weights) for c in steps]
    still = np.asarray(weights) @ pair.lattice.centers - pair.lattice.centers[0]
    np.testing.assert_allclose(moves[0][0].vertices, moves[0][0].rest.vertices + still, atol=1e-4)
    changes = [spread(a, b) for a, b in pairwise(moves)]
    assert max(changes) < 0.25 * spread(moves[0], moves[10])
    assert min(changes) > 0.0


def test_paths_are_smooth(pair):
    moves = [pair.moved((1.0 - t, t)) for t in np.linspace(0.02, 0.98, 25)]
    changes = [spread(a, b) for a, b in pairwise(moves)]
    assert max(changes) < 3.0 * np.mean(changes)


def test_three_shapes_agree_with_two_at_the_edges(three):
    for weights in ((0.3, 0.7, 0.0), (0.0, 0.5, 0.5), (0.8, 0.0, 0.2)):
        inner = 0.999 * np.array(weights) + 0.001 / 3.0
        at_edge, inside = three.moved(weights), three.moved(inner.tolist())
        assert [move is None for move in at_edge] == [weight == 0.0 for weight in weights]
        assert spread(at_edge, inside) < 0.05


def test_only_the_weights_decide(three):
    weights = (0.2, 0.5, 0.3)
    before = three.moved(weights)
    three.moved((0.6, 0.1, 0.3))
    assert spread(before, three.moved(weights)) == 0.0


def test_pairs_that_were_not_made_are_refused():
    motion = warp([LONG, TALL, CROSS], [(0, 1)], effort=LEAST)
    assert motion.moved((0.0, 0.0, 1.0))[2] is not None
    with pytest.raises(ValueError, match="between the shapes 0 and 2"):
        motion.moved((0.5, 0.0, 0.5))


def test_it_is_the_same_in_another_process_and_the_next_time(pair):
    weights = (0.3, 0.7)
    expected = pair.moved(weights)
    assert spread(pickle.loads(pickle.dumps(pair)).moved(weights), expected) == 0.0
    assert spread(warp([LONG, TALL]).moved(weights), expected) == 0.0


@pytest.mark.parametrize(
    "shape",
    [
        square(2.0),
        with_faces(torus(), np.arange(2304) < 2000),
        joined(*(box((0.3, 0.3, 0.3), center=(x, y, 0.2 * x * y)) for x in (-1, 0, 1) for y in (-1, 0, 1))),
        ball().flipped(),
        TriangleMesh(np.concatenate([ball(points=300).vertices, [(50.0, 0.0, 0.0)]]), ball(points=300).faces),
        TriangleMesh.from_arrays([(0, 0, 0), (1, 0, 0), (2, 1e-9, 0)], [(0, 1, 2)]),
    ],
    ids=["sheet", "open", "crumbs", "inside out", "loose vertex", "needle"],
)
def test_bad_meshes_move_too(shape):
    motion = warp([shape, LONG], effort=LEAST)
    for move, own in zip(motion.moved((0.5, 0.5)), (shape, LONG), strict=True):
        assert move.parents is None or set(move.parents) == set(range(len(own.faces)))
        assert np.isfinite(move.vertices).all()
        assert np.abs(move.vertices[move.rest.faces]).max() < 5.0


def test_invalid_input_is_refused():
    empty = TriangleMesh.from_arrays(np.zeros((3, 3)), np.zeros((0, 3), int))
    with pytest.raises(InputError, match="'shape 1' has no faces"):
        warp([LONG, empty])
    with pytest.raises(InputError, match="coherence"):
        warp([LONG, TALL], coherence=1.5)
    with pytest.raises(InputError, match="coherence"):
        warp([LONG, TALL], effort=LEAST).with_coherence(-0.1)


def test_progress_rises_and_it_can_be_stopped():
    control, seen = Control(), []
    with pytest.raises(Cancelled):
        for report in warp_motion([LONG, TALL], ["a", "b"], [(0, 1)], 0.5, control, EFFORT):
            assert isinstance(report, Progress)
            seen.append(report.fraction)
            if len(seen) == 4:
                control.cancel()
    assert seen == sorted(seen)
    assert len(seen) == 4
