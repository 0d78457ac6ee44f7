# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The coherence benchmark bakes with the application and measures the result."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks import (
    coherence_cases,
    coherence_maps,
)
from benchmarks.coherence_cases import Bake, held, passage, read_frames
from benchmarks.coherence_pairs import Ends
from convwass_addon.geometry.meshes.closest_points import ClosestPointFinder
from tests.shapes import ball


def test_a_pair_is_baked_measured_and_stored(tmp_path):
    found = passage("star to cross", "transport", cells=24, frames=4, keep=str(tmp_path / "frames"))
    assert found["pieces"] == 1
    assert found["volume"] < 0.1
    assert 0.7 < found["area"][0] <= found["area"][1] < 1.2
    assert found["limb"] is None
    assert [list(record["weights"]) for record in found["records"]] == [[0.75, 0.25], [0.5, 0.5], [0.25, 0.75]]
    meshes = read_frames(tmp_path / "frames.npz")
    assert len(meshes) == 5
    assert coherence_cases.Along.of(meshes, np.linspace(0, 1, 5)).area.min() == pytest.approx(found["area"][0])


def test_torn_frames_have_more_components_than_the_shapes_before_mending():
    shape = ball(radius=1.0)
    records = [{"found": {"pieces": pieces}} for pieces in (1, 2, 3)]
    bake = Bake([shape] * 5, np.linspace(0, 1, 5), records, 0.1, {"cpu": 1.0, "wall": 1.0})
    found = held(bake, Ends(shape, shape))
    assert found["pieces"] == 3
    assert found["torn"] == pytest.approx(2 / 3)


class _Led:
    """A motion between a mesh and itself whose map shifts the vertex indices."""

    def __init__(self, mesh, shift):
        order = np.roll(np.arange(len(mesh.vertices)), shift)
        images = ClosestPointFinder(mesh.corners).find(mesh.vertices[order])
        self.carriers = [SimpleNamespace(mesh=mesh)] * 2
        self.deformations = {key: SimpleNamespace(images=images) for key in ((0, 1), (1, 0))}


def test_tips_mapped_to_another_tip_are_astray():
    mesh = ball(points=40)
    tips = np.stack([mesh.vertices[[3, 20, 33]]] * 2)
    assert not coherence_maps.astray(_Led(mesh, 0), tips).any()
    assert coherence_maps.astray(_Led(mesh, 17), tips)[0, 1]
