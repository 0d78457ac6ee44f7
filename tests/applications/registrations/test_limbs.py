# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes without limbs fill their convex hulls, also if they have many vertices."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.registrations.limbs import is_compact
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from tests.shapes import ball, box, joined, square, torus


@pytest.mark.parametrize(
    ("shape", "expected"),
    [
        (box(), True),
        (ball(), True),
        (ball(points=20_000), True),
        # Half of its convex hull.
        (joined(box((1.0, 1.0, 1.0)), box((1.0, 1.0, 1.0), (2.0, 0.0, 0.0))), False),
        (torus(), False),
        (torus(segments=(200, 100)), False),
        (square(), False),
    ],
    ids=["box", "ball", "fine ball", "two boxes", "ring", "fine ring", "flat"],
)
def test_compact_shapes_fill_their_hulls(shape, expected):
    assert is_compact(shape) == expected
    assert is_compact(TriangleMesh(1e-3 * shape.vertices[:, [1, 2, 0]] + 5.0, shape.faces)) == expected


def test_loose_vertices_do_not_count():
    shape = box()
    assert is_compact(TriangleMesh(np.concatenate([shape.vertices, [[9.0, 9.0, 9.0]]]), shape.faces))
