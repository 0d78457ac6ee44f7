# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A frame next to a shape is compared with it; motion and change of volume do not count."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.end_frames import EndLoss
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from tests.shapes import ball


def test_a_smaller_ball_has_no_loss():
    loss = EndLoss.of(ball(points=2000), ball(0.98, points=2000), 0.05)
    assert loss.area == pytest.approx(0.0, abs=1e-3)
    assert loss.detail == pytest.approx(0.0, abs=1e-2)


def test_missing_bumps_are_lost_detail():
    smooth = ball(points=4000)
    bumps = np.sin(12.0 * smooth.vertices).prod(axis=1, keepdims=True)
    bumpy = TriangleMesh(smooth.vertices * (1.0 + 0.1 * bumps), smooth.faces)
    loss = EndLoss.of(bumpy, smooth, 0.05)
    # The mean magnitude of a sine is 2 / pi.
    assert loss.detail == pytest.approx(0.1 / 0.05 * (2.0 / np.pi) ** 3, rel=0.2)
    assert loss.area > 0.03
