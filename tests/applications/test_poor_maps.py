# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors for shapes that one mesh cannot take."""

from __future__ import annotations

import pytest

from convwass_addon.applications.one_mesh.poor_maps import poor_map_error
from convwass_addon.progress import UNINTERRUPTED
from tests.shapes import ball, box, joined, torus, with_faces


def message(first, second):
    return str(poor_map_error(first, second, ("Cup", "Ball"), 0.35, UNINTERRUPTED))


@pytest.mark.parametrize(
    ("first", "counts"),
    [
        (torus(), "Cup (pieces: 1, holes: 1, hollows: 0)"),
        (joined(box(), box(center=(3, 0, 0))), "Cup (pieces: 2, holes: 0, hollows: 0)"),
    ],
)
def test_a_different_topology_is_named_with_what_to_do(first, counts):
    found = message(first, ball(points=200))
    assert counts in found and "Ball (pieces: 1, holes: 0, hollows: 0)" in found and "another output" in found


def test_otherwise_guides_are_advised():
    open_box = with_faces(box(), list(range(10)))
    assert "Add guides" in message(box(), ball(points=200)) and "Add guides" in message(open_box, torus())
