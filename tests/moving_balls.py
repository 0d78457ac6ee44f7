# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Baked paths of balls with known positions at all times."""

from __future__ import annotations

from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph_problem import MorphFrame
from convwass_addon.bridge.morphs.bake import MorphBake
from convwass_addon.bridge.objects import write_mesh
from tests.shapes import ball

CELLS, FRAMES, FIRST = 24, 3, 10
TRAVEL = 4.0
"""Distance between the first and the last ball, in radii."""


def bake(make_object, meshes, blends, solved):
    """Bake shapes, and the blends that `solved` makes from weights."""
    shapes = [make_object(name) for name in "ABCD"[: len(meshes)]]
    for shape, mesh in zip(shapes, meshes, strict=True):
        write_mesh(shape.data, mesh)
    made = MorphBake.begin(shapes, blends, {"resolution": CELLS}, FIRST)
    for blend in blends:
        made.add(MorphFrame(blend, None if blend.source is not None else solved(blend.weights), {}))
    return made.finish(hide_inputs=True)


def moving_ball(make_object):
    """Bake a ball of radius 1 that moves along X by `TRAVEL` in `FRAMES` frames, starting at `FIRST`."""

    def solved(weights):
        return ball(center=(TRAVEL * weights[1], 0.0, 0.0), points=2500)

    return bake(make_object, [solved((1, 0)), solved((0, 1))], path_blends(2, FRAMES), solved)
