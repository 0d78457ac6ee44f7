# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Offsets that turn with the surface."""

from __future__ import annotations

import numpy as np

from convwass_addon.applications.one_mesh.turned_offsets import TurnedOffsets
from tests.shapes import ball


def about_z(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def test_offsets_turn_with_the_mesh_and_grow_evenly():
    mesh = ball(points=200)
    offsets = np.zeros_like(mesh.vertices)
    offsets[[3, 40, 41]] = [[0.1, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.3]]
    end, half = about_z(1.6), about_z(0.8)
    taken = TurnedOffsets.of(mesh, mesh.vertices @ end.T, offsets @ end.T)
    for turn, share in ((end, 1.0), (half, 0.5)):
        guided = mesh.vertices @ turn.T
        np.testing.assert_allclose(
            taken.added(guided, guided, share), (mesh.vertices + share * offsets) @ turn.T, atol=1e-9
        )


def test_without_offsets_vertices_stay():
    mesh = ball(points=100)
    assert (
        TurnedOffsets.of(mesh, mesh.vertices, np.zeros_like(mesh.vertices)).added(mesh.vertices, mesh.vertices, 1.0)
        is mesh.vertices
    )
