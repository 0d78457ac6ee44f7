# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Spans across thin parts, on shapes whose middle is known."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.remeshing.subdivision import with_short_edges
from convwass_addon.geometry.solids.thin_spans import ThinSpans
from tests.shapes import ball, bent, box, joined, rotated, torus, tube_with_caps

TURN = np.array([0.5, 0.3, 0.2])


def test_spans_cross_a_sheet_straight_and_cover_it():
    plate = rotated(box((10.0, 8.0, 0.5)), TURN)
    spans = ThinSpans.of(plate, 3.0)
    flat = rotated(TriangleMesh(spans.middles(plate, 3.0), np.empty((0, 3), np.int64)), -TURN).vertices
    assert np.abs(flat[:, 2]).max() < 1e-9
    grid = np.stack(np.meshgrid(np.linspace(-4.8, 4.8, 25), np.linspace(-3.8, 3.8, 25)), axis=-1).reshape(-1, 2)
    assert cKDTree(flat[:, :2]).query(grid)[0].max() < 0.5
    assert len(spans.middles(plate, 0.49)) == 0


def test_spans_of_a_rod_pass_through_its_axis():
    ring = torus(10.0, 0.4, segments=(240, 24))
    middles = ThinSpans.of(ring, 3.0).middles(ring, 3.0)
    away = np.hypot(np.linalg.norm(middles[:, :2], axis=1) - 10.0, middles[:, 2])
    assert away.max() < 0.1
    angles = np.sort(np.arctan2(middles[:, 1], middles[:, 0]))
    assert 10.0 * np.diff(angles).max() < 0.6


def test_thick_bodies_have_none():
    for body in (ball(3.0), box((4.0, 4.0, 4.0)), tube_with_caps(2.0, 6.0)):
        assert len(ThinSpans.of(body, 3.0).middles(body, 3.0)) == 0


def test_no_span_crosses_the_gap_to_another_part():
    """The facing sides of two sheets look towards each other, the outer ones away from each other."""
    sheets = joined(box((8.0, 8.0, 0.4), (0.0, 0.0, -0.4)), box((8.0, 8.0, 0.4), (0.0, 0.0, 0.4)))
    middles = ThinSpans.of(sheets, 3.0).middles(sheets, 3.0)
    assert len(middles) > 100
    np.testing.assert_allclose(np.abs(middles[:, 2]), 0.4, atol=1e-9)


def test_middles_follow_a_sheet_that_is_bent():
    plate = with_short_edges(box((4.0, 0.5, 10.0)), 0.5, 20_000).mesh
    spans = ThinSpans.of(plate, 3.0)
    middles = spans.middles(plate, 3.0)
    moved = spans.middles(TriangleMesh(bent(plate.vertices, 1.5), plate.faces), 3.0)
    assert len(moved) == len(middles)
    ends = [(0.0, 0.0, -5.0), (0.0, 0.0, 5.0)]
    np.testing.assert_allclose(moved, bent(np.vstack([middles, ends]), 1.5)[:-2], atol=0.02)


def test_spans_that_have_become_too_long_are_left_out():
    plate = box((10.0, 8.0, 0.5))
    spans = ThinSpans.of(plate, 3.0)
    thick = TriangleMesh(plate.vertices * [1.0, 1.0, 4.0], plate.faces)
    assert len(spans.middles(thick, 1.9)) == 0
    assert len(spans.middles(thick, 2.1)) == len(spans.middles(plate, 1.9)) > 0
