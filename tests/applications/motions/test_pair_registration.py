# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Registrations of bodies whose joints are known."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.coherence_pairs import pairs_named
from convwass_addon.applications.motions.guided_motion import guided_motion
from convwass_addon.applications.motions.guided_settings import GuidedSettings
from convwass_addon.progress import drained


@pytest.fixture(scope="module")
def raised_arm():
    (pair,) = pairs_named(["man raises arm"], None)
    return pair.ends()


@pytest.fixture(scope="module")
def motion(raised_arm):
    shapes = [raised_arm.first, raised_arm.second]
    return drained(guided_motion(shapes, ["down", "up"], [(0, 1)], GuidedSettings()))


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
