# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Signed distances on a grid, against those of balls."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.bridge.files.openvdb_module import openvdb_module
from convwass_addon.bridge.morphs.fields.field_sampling import closed_surface, signed_distances
from convwass_addon.bridge.morphs.fields.stored_fields import BAND
from convwass_addon.errors import Cancelled
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import Control
from tests.shapes import ball, joined

SHAPE = (30, 26, 26)
POINTS = np.stack(np.meshgrid(*(np.arange(n) for n in SHAPE), indexing="ij"), axis=-1)
FIRST, SECOND, RADIUS = (11.2, 12.7, 12.4), (18.3, 12.7, 12.4), 7.5


def inside(center):
    """Signed distance from a ball, positive inside."""
    return RADIUS - np.linalg.norm(POINTS - center, axis=-1)


def sampled(mesh):
    return signed_distances(openvdb_module(), closed_surface(mesh, SHAPE), SHAPE)


def test_distances_of_a_ball():
    found = sampled(ball(RADIUS, FIRST, points=3000))
    off = np.abs(found - np.clip(inside(FIRST), -BAND, BAND))
    # OpenVDB misses the closest triangle of a few samples that are more than two cells away.
    assert off[np.abs(inside(FIRST)) < 1.5].max() <= 0.05
    assert np.quantile(off, 0.999) <= 0.05
    assert off.max() <= 0.4


def test_surfaces_inside_of_a_shape_do_not_count():
    """Two balls overlap, so that a part of each is inside of the other."""
    both = joined(*(ball(RADIUS, center, points=1500) for center in (FIRST, SECOND)))
    found = sampled(both)
    expected = np.clip(np.maximum(inside(FIRST), inside(SECOND)), -BAND, BAND)
    # Where they meet, the surface is extracted from cells and rounded.
    crease = np.abs(inside(FIRST) - inside(SECOND)) < 3.0
    assert np.abs(found - expected)[~crease].max() <= 0.4
    assert found[15, 13, 12] == BAND


def test_a_shape_with_a_hole_has_an_inside():
    whole = ball(RADIUS, FIRST, points=1500)
    open_one = TriangleMesh(whole.vertices, whole.faces[whole.corners[:, :, 2].max(axis=1) < FIRST[2] + 0.97 * RADIUS])
    assert len(open_one.faces) < len(whole.faces)
    found = sampled(open_one)
    assert np.abs(found - np.clip(inside(FIRST), -BAND, BAND)).max() <= 0.6


def test_a_shape_is_given_up_when_it_is_stopped():
    whole = ball(RADIUS, FIRST, points=3000)
    control = Control()
    control.cancel()
    with pytest.raises(Cancelled):
        closed_surface(TriangleMesh(whole.vertices, whole.faces[1:]), SHAPE, control)
