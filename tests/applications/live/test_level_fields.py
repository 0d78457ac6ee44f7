# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Mixed level fields against balls, whose blends are known, and the lattices of weights."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.live.level_fields import FieldBox, LevelField, MixedField, mixed
from convwass_addon.applications.live.weight_layouts import (
    PathLayout,
    SquareLayout,
    TriangleLayout,
    checked_weights,
    layout_of,
    path_weights,
)
from convwass_addon.errors import InputError
from convwass_addon.geometry.meshes.centroid import centroid
from tests.applications.live.fields import BOX, CENTER, ball_field, radius_of

LAYOUTS = [PathLayout(2), PathLayout(4), TriangleLayout(), SquareLayout()]


def balls_between(steps: int, share: float) -> MixedField:
    """Mix balls of two of the volumes that `steps` steps interpolate from a radius of 5 to one of 9."""
    layout = PathLayout(2)
    stencil = layout.stencil((1.0 - share, share), steps)
    volumes = [np.dot(layout.weights(node, steps), (5.0**3, 9.0**3)) for node in stencil.nodes]
    return mixed([ball_field(float(np.cbrt(volume))) for volume in volumes], stencil.shares)


@pytest.mark.parametrize("share", [0.0, 0.11, 0.4375, 0.5, 0.98, 1.0])
def test_mixed_balls_are_the_balls_between(share):
    found = balls_between(8, share)
    mesh = found.surface()
    radius = np.cbrt((1.0 - share) * 5.0**3 + share * 9.0**3)
    assert radius_of(found.volume) == pytest.approx(radius)
    distances = np.linalg.norm(mesh.vertices - CENTER, axis=1)
    # Triangles cut corners, which the level makes up for: vertices are a little outside.
    np.testing.assert_allclose(distances, radius, atol=0.12)
    assert distances.mean() == pytest.approx(radius, abs=0.06)
    assert mesh.volume == pytest.approx(found.volume, rel=0.01)
    np.testing.assert_allclose(centroid(mesh), CENTER, atol=0.01)


def test_balls_far_apart_in_the_lattice_keep_their_volume():
    # The linear mixture of two balls is a ball too small or too large; the level is not.
    found = balls_between(2, 0.25)
    assert found.surface().volume == pytest.approx(found.volume, rel=0.02)


def test_surfaces_are_closed_where_fields_are_cut_off_by_the_box():
    small = FieldBox.between(CENTER.astype(int), BOX.high)
    mesh = mixed([ball_field(6.0, box=small)], [1.0]).surface()
    _, counts = np.unique(np.sort(mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0, return_counts=True)
    assert set(counts) == {2}
    assert mesh.volume > 0


def test_fields_are_stored_only_where_the_density_is_positive():
    small = LevelField.of(np.pad(np.ones((4, 5, 6)), 3), (0, 4, 2), 0.5, 120.0, BOX)
    np.testing.assert_array_equal(small.box.low, (3, 7, 5))
    assert small.box.shape == (4, 5, 6) and small.nbytes == 2 * 120
    larger = LevelField.of(
        np.pad(np.ones((4, 5, 6)), 3), (0, 4, 2), 0.5, 120.0, BOX.union(FieldBox.between((-9, 0, 0), (10, 40, 33)))
    )
    assert larger.nbytes == small.nbytes and larger.cells == small.cells
    np.testing.assert_array_equal(mixed([larger], [1.0]).surface().vertices, mixed([small], [1.0]).surface().vertices)


def test_mixtures_of_fields_in_different_boxes_are_those_of_their_values():
    cells = [ball_field(4.0, CENTER + shift) for shift in ([-2.0, 0.0, 1.0], [3.0, 1.0, -2.0], [0.0, -2.0, 0.0])]
    shares = [0.5, 0.3, 0.2]
    found = mixed(cells, shares)
    points = np.moveaxis(np.indices(found.values.shape), 0, -1) + found.low
    expected = np.zeros(found.values.shape)
    for field, share in zip(cells, shares, strict=True):
        inside = ((points >= field.box.low) & (points < field.box.high)).all(axis=-1)
        own = np.full(found.values.shape, -1.0)
        own[inside] = field.values[tuple((points[inside] - field.box.low).T)]
        expected += share * own
    # Values next to the level are moved away from it.
    np.testing.assert_allclose(found.values, expected, atol=3e-4)


def test_a_field_without_a_cell_inside_is_refused():
    with pytest.raises(InputError, match="fills no cell"):
        LevelField.of(np.full((3, 3, 3), 0.2), (0, 2, 0), 0.5, 1.0, BOX)


def test_difference_is_that_of_the_masses():
    small, large = ball_field(5.0), ball_field(6.0)
    # One lies within the other.
    expected = 2.0 * (6.0**3 - 5.0**3) / (6.0**3 + 5.0**3)
    assert small.difference(large) == pytest.approx(expected, rel=0.1)
    assert ball_field(4.0).difference(ball_field(4.0, CENTER + np.array([0.0, 0.0, 8.0]))) == pytest.approx(
        2.0, abs=0.1
    )
    assert small.difference(small) == 0.0


@pytest.mark.parametrize("layout", LAYOUTS, ids=lambda layout: f"{type(layout).__name__} {layout.count}")
@pytest.mark.parametrize("steps", [1, 4, 12])
def test_stencils_interpolate_the_weights(layout, steps):
    nodes, random = layout.nodes(steps), np.random.default_rng(0)
    assert len(set(nodes)) == len(nodes)
    for node in nodes:
        assert layout.stencil(layout.weights(node, steps), steps).nodes == (node,)
        assert set(layout.neighbors(node, steps)) <= set(nodes) - {node}
    for _ in range(40):
        # A mixture of a stencil lies in the layout.
        start = nodes[random.integers(len(nodes))]
        around = np.array([layout.weights(node, steps) for node in (start, *layout.neighbors(start, steps)[:1])])
        weights = random.dirichlet(np.ones(len(around))) @ around
        stencil = layout.stencil(weights, steps)
        assert set(stencil.nodes) <= set(nodes)
        assert min(stencil.shares) > 0 and sum(stencil.shares) == pytest.approx(1.0)
        found = np.array(stencil.shares) @ np.array([layout.weights(node, steps) for node in stencil.nodes])
        if layout.count == 3 or not isinstance(layout, SquareLayout):
            np.testing.assert_allclose(found, weights, atol=1e-9)
        for node in stencil.nodes:
            assert set(stencil.nodes) - {node} <= set(layout.neighbors(node, steps))


def test_weights_out_of_range_are_brought_back():
    np.testing.assert_allclose(checked_weights((3.0, 1.0), 2), (0.75, 0.25))
    np.testing.assert_allclose(checked_weights((0.5, -0.2), 2), (1.0, 0.0))
    np.testing.assert_allclose(checked_weights((3e300, 1e300), 2), (0.75, 0.25))
    np.testing.assert_allclose(path_weights(-3.0, 3), (1, 0, 0))
    np.testing.assert_allclose(path_weights(np.inf, 3), (0, 0, 1))
    np.testing.assert_allclose(path_weights(1.25, 3), (0, 0.75, 0.25))


@pytest.mark.parametrize(
    ("weights", "message"), [((1, 1, 1), "there are 3"), ((0, -1), "All weights"), ((np.nan, 1), "finite")]
)
def test_weights_without_a_meaning_are_refused(weights, message):
    with pytest.raises(InputError, match=message):
        checked_weights(weights, 2)


def test_five_shapes_have_no_pad():
    assert layout_of(4) == SquareLayout()
    with pytest.raises(InputError, match="not 5"):
        layout_of(5)
