# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Registrations of bodies whose joints are known."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.coherence_pairs import pairs_named
from convwass_addon.applications.motions.guided_motion import guided_motion
from convwass_addon.applications.motions.guided_settings import GuidedSettings
from convwass_addon.applications.registrations import pair_registration
from convwass_addon.applications.registrations.carriers import carrier_of
from convwass_addon.applications.registrations.laid_meshes import Laid
from convwass_addon.applications.registrations.pair_registration import LaidPair, laid_on_each_other
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import UNINTERRUPTED, drained
from tests.grids import figure, sheet


@pytest.fixture(scope="module", autouse=True)
def coarse():
    """Try starts on meshes of half as many vertices as usual."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pair_registration, "_DRAFT_VERTICES", 800)
        yield


@pytest.fixture(scope="module")
def raised_arm():
    (pair,) = pairs_named(["man raises arm"], None)
    return pair.ends()


@pytest.fixture(scope="module")
def motion(raised_arm):
    shapes = [raised_arm.first, raised_arm.second]
    return drained(guided_motion(shapes, ["down", "up"], [(0, 1)], GuidedSettings(carrier_vertices=1500)))


def along(points, joints):
    """Positions along an arm, from 0 at the shoulder to 1 at the finger tips, and distances from its axis."""
    arm = joints[-1] - joints[0]
    length = np.linalg.norm(arm)
    shares = (points - joints[0]) @ arm / length**2
    return shares, np.linalg.norm(points - joints[0] - np.outer(shares, arm), axis=1)


@pytest.mark.parametrize(("shape", "own", "other"), [(0, 0.0, 1.0), (1, 1.0, 0.0)])
def test_skin_keeps_its_place_along_an_arm_that_is_raised(raised_arm, motion, shape, own, other):
    """Where the arm hangs beside the trunk, there is skin on one of the shapes only."""
    limb = raised_arm.limb
    moved = motion.moved([1e-9, 1.0 - 1e-9] if other else [1.0 - 1e-9, 1e-9])[shape]
    before, away = along(moved.rest.vertices, limb.at(own))
    after, _ = along(moved.vertices, limb.at(other))
    for low in (0.45, 0.55, 0.65, 0.75, 0.85):
        ring = (before >= low) & (before < low + 0.1) & (away < 0.12)
        assert np.median(after[ring] - before[ring]) == pytest.approx(0.0, abs=0.07)


@pytest.mark.parametrize(
    ("firm", "spread", "expected"), [(0.97, None, 0.97), (0.6, 0.7, 0.7), (0.6, 0.61, 0.6), (0.6, 0.5, 0.6)]
)
def test_strain_is_spread_where_that_is_clearly_more_consistent(monkeypatch, firm, spread, expected):
    carrier = carrier_of(figure()[0], "figure", 600, UNINTERRUPTED)
    start = Laid(carrier.rest.vertices, np.ones(len(carrier.rest.vertices)))
    yields = []

    def finished(_shapes, _starts, _pairs, stages, _control):
        yields.append(stages[-1].give)
        return LaidPair(start, start, spread if stages[-1].give is None else firm)

    monkeypatch.setattr(pair_registration, "_finished", finished)
    no_pairs = np.empty((0, 2), np.int64)
    found = pair_registration._finely((carrier, carrier), (start, start), (no_pairs, no_pairs), UNINTERRUPTED)
    assert found.confidence == expected
    assert yields == ([0.8] if spread is None else [0.8, None])


def test_flat_shapes_do_not_follow_every_bump():
    """A bar and one with wavy edges: the edges of the first stay straight within a fifth of the waves."""
    plain = sheet(121, 21, (3.0, 0.5))
    x, y, z = (plain.vertices - (0.0, 0.25, 0.0)).T
    waves = 1.0 + 0.4 * np.cos(2.0 * np.pi * x / 0.6)
    bars = [TriangleMesh(np.column_stack([x, own, z]), plain.faces) for own in (y, waves * y)]
    carriers = tuple(carrier_of(bar, "bar", 6000, UNINTERRUPTED) for bar in bars)
    starts = tuple(Laid(own.rest.vertices, np.ones(len(own.rest.vertices))) for own in carriers)
    found = laid_on_each_other(carriers, starts, np.empty((0, 2), np.int64), None, UNINTERRUPTED)
    edge = (np.abs(y) > 0.249) & (np.abs(x - 1.5) < 1.2)
    heights = np.abs(found.first.points[edge, 1])
    assert np.ptp(heights) < 0.2 * np.ptp(0.25 * waves)
    assert found.confidence > 0.98
