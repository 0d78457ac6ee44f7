# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Vessels that become solids: they fill up while their outside moves, and solids that become vessels are hollowed."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.props import bottle, revolved, vase
from convwass_addon.applications.motions.motion_memory import MotionMemory
from convwass_addon.applications.motions.motion_request import MotionRequest
from convwass_addon.geometry.meshes.edges import topology
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.solids.occupancy import occupancy
from convwass_addon.geometry.solids.orientation import orient_outward
from convwass_addon.progress import UNINTERRUPTED, drained
from tests.applications.maps import coarse_surfaces
from tests.revolutions import BOWL, asideness, floor

TIMES = (0.25, 0.5, 0.75)
VASE, BOTTLE = vase(), bottle()
# A cup of radius 1 and height 2, with a cavity of radius 0.75 and depth 1.5, and the cylinder around it.
CYLINDER = revolved([(0.0, 0.0), (1.0, 0.0), (1.0, 2.0), (0.0, 2.0)], 32)
HOLLOW = revolved([(0.0, 0.0), (1.0, 0.0), (1.0, 2.0), (0.75, 2.0), (0.75, 0.5), (0.0, 0.5)], 32)
BALL = revolved([(np.sin(t), -np.cos(t)) for t in np.linspace(0.0, np.pi, 17)], 24)
MOTIONS = MotionMemory()


@pytest.fixture(scope="module", autouse=True)
def coarse():
    with coarse_surfaces():
        yield


def choice(*shapes, coherence=0.5, pairs=((0, 1),)):
    request = MotionRequest(shapes, [str(k) for k in range(len(shapes))], list(pairs), "automatic", coherence)
    found = drained(MOTIONS.chosen(request, UNINTERRUPTED))
    assert found.reason == "OUTLINES"
    return found


def upside_down(mesh):
    return TriangleMesh(mesh.vertices * (1.0, -1.0, -1.0), mesh.faces)


def similarity(one, other):
    """Volume of the intersection of two solids over that of their union."""
    low = np.minimum(one.bounds[0], other.bounds[0])
    cell = np.ptp([one.bounds, other.bounds], axis=(0, 1)).max() / 50.0
    fields = [occupancy((mesh.corners - low) / cell + 3.0, (60, 60, 60)) for mesh in (one, other)]
    return np.minimum(*fields).sum() / np.maximum(*fields).sum()


@pytest.mark.parametrize("time", TIMES)
@pytest.mark.parametrize("turned", [False, True])
def test_a_cup_becomes_the_cylinder_around_it(time, turned):
    """Its floor rises evenly, from a quarter of the height, and nothing else moves."""
    shapes = [upside_down(own) if turned else own for own in (HOLLOW, CYLINDER)]
    for own in choice(*shapes).motion.moved([1.0 - time, time]):
        mesh = upside_down(own.mesh) if turned else own.mesh
        width, depth, height = np.ptp(mesh.bounds, axis=0)
        assert (width / height, depth / height) == pytest.approx((1.0, 1.0), abs=0.01)
        assert floor(mesh) == pytest.approx(0.25 + 0.75 * time, abs=0.02)


@pytest.mark.parametrize("pair", [(VASE, BOTTLE), (BALL, BOWL)], ids=["vase to bottle", "ball to bowl"])
@pytest.mark.parametrize("time", [0.1, 0.5, 0.9])
def test_both_shapes_are_the_same_solid_of_the_volume_of_similar_shapes(pair, time):
    wanted = ((1.0 - time) * np.cbrt(pair[0].volume) + time * np.cbrt(pair[1].volume)) ** 3
    one, other = (own.mesh for own in choice(*pair).motion.moved([1.0 - time, time]))
    assert similarity(one, other) > 0.9
    for mesh in (one, other):
        assert wanted / 1.06 < mesh.volume < 1.06 * wanted
    vessel = one if pair[0] is VASE else other
    assert asideness(vessel, (0.0, 0.0, 1.0), (0.0, 0.0, 0.0)) < 0.05


@pytest.mark.parametrize("time", TIMES)
def test_a_vase_is_hardly_lower_on_the_way(time):
    """If its section were deformed, it would be a third lower."""
    moved = choice(VASE, BOTTLE).motion.moved([1.0 - time, time])[0].mesh
    heights = np.ptp(VASE.bounds, axis=0)[2], np.ptp(BOTTLE.bounds, axis=0)[2]
    assert np.ptp(moved.bounds, axis=0)[2] > 0.93 * ((1.0 - time) * heights[0] + time * heights[1])


def test_the_mouth_becomes_the_top_of_the_neck_which_stays_hollow():
    """Where it is narrow, half of its radius is, so that no bubble is enclosed."""
    moved = choice(VASE, BOTTLE).motion.moved([0.1, 0.9])[0]
    rim = VASE.vertices[:, 2] > VASE.bounds[1, 2] - 1e-6
    low, high = moved.mesh.bounds[:, 2]
    assert moved.vertices[: len(VASE.vertices)][rim, 2].min() > high - 0.02 * (high - low)
    heights, radii = moved.vertices[:, 2], np.hypot(moved.vertices[:, 0], moved.vertices[:, 1])
    neck = (heights > high - 0.15) & (heights < high - 0.05)
    assert radii[neck].min() > 0.4 * radii[neck].max()
    assert floor(moved.mesh) < 0.97


def test_walls_stay_as_thick_where_there_is_room():
    moved = choice(VASE, BOTTLE).motion.moved([0.4, 0.6])[0]
    center = moved.vertices[:, 2] - moved.mesh.bounds[0, 2]
    radii = np.hypot(moved.vertices[:, 0], moved.vertices[:, 1])
    middle = (center > 0.75) & (center < 0.8)
    outside = radii[middle].max()
    inside = radii[middle & (radii < 0.97 * outside)].max()
    assert outside - inside > 0.04


def test_at_rest_a_lent_cavity_is_flat_and_closed():
    motion = choice(HOLLOW, CYLINDER).motion
    cup, cylinder = motion.moved([1.0, 0.0])[0], motion.moved([0.0, 1.0])[1]
    np.testing.assert_allclose(cup.vertices, cup.rest.vertices, rtol=0.0, atol=1e-6)
    np.testing.assert_allclose(cylinder.vertices, cylinder.rest.vertices, rtol=0.0, atol=1e-6)
    assert cylinder.mesh.volume == pytest.approx(CYLINDER.volume, rel=1e-3)
    assert topology(cylinder.mesh).closed
    assert cylinder.parents.max() < len(CYLINDER.faces)


def test_a_lent_cavity_of_an_open_solid_stays_a_cavity():
    """Its pole is open, by rounding; a cavity has no seam with it."""
    angles = np.linspace(0.0, np.pi, 40)
    egg = revolved([(np.sin(t) * 0.5 * (1.0 - 0.15 * np.cos(t)), 0.7 - 0.7 * np.cos(t)) for t in angles])
    assert not topology(egg).closed
    outside = [(0.0, 0.0), (0.42, 0.0), (0.42, 1.0), (0.15, 1.4), (0.15, 1.9)]
    inside = [(0.11, 1.9), (0.11, 1.38), (0.37, 0.97), (0.37, 0.06), (0.0, 0.06)]
    moved = choice(revolved([*outside, *inside]), egg).motion.moved([0.5, 0.5])[1].mesh
    assert orient_outward(moved).volume == pytest.approx(moved.volume, rel=1e-3)


def test_a_path_from_a_vessel_over_a_solid_to_a_vessel():
    motion = choice(HOLLOW, CYLINDER, BOWL, pairs=((0, 1), (1, 2))).motion
    for weights, wanted in (([0.5, 0.5, 0.0], 0.625), ([0.0, 0.98, 0.02], 0.97)):
        first, second = (own.mesh for own in motion.moved(weights) if own is not None)
        assert similarity(first, second) > 0.9
        assert floor(first) == pytest.approx(wanted, abs=0.03)


def test_with_less_coherence_only_the_vessel_is_hollow():
    cup, cylinder = choice(HOLLOW, CYLINDER, coherence=0.25).motion.moved([0.5, 0.5])
    assert floor(cup.mesh) < 0.7
    assert floor(cylinder.mesh) == pytest.approx(1.0, abs=0.02)
    assert len(cylinder.vertices) < len(choice(HOLLOW, CYLINDER).motion.moved([0.5, 0.5])[1].vertices)
