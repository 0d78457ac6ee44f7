# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import bpy
import pytest

from convwass_addon.applications.morphs.extraction import Constraint, connectivity_of, extract_surface
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph import morph
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.bridge.files.imports import import_objects
from convwass_addon.bridge.objects import triangle_mesh
from convwass_addon.geometry.level_sets.mending import Connectivity
from convwass_addon.geometry.meshes.edges import topology
from convwass_addon.geometry.solids.occupancy import occupancy
from convwass_addon.geometry.solids.surface_bounds import SurfaceBounds
from tests.shapes import ball, box, joined, piece_count, torus

ASSETS = Path(__file__).parents[2] / "assets" / "shapes"
PLAIN = MorphSettings(motion="transport", resolution=40, thin_parts=False, mend=False)


def animals():
    """A horse and a bird, whose legs and wings transport tears off."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    objects = [obj for name in ("horse", "bird") for obj in import_objects(ASSETS / f"{name}.ply", None)]
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return [triangle_mesh(obj, depsgraph) for obj in objects]


def frames_of(shapes, count, settings):
    inputs = MorphInputs.of(shapes, [f"shape {i}" for i in range(len(shapes))])
    steps = morph(inputs, path_blends(len(shapes), count), settings)
    return [step.payload for step in steps if step.payload and step.payload.mesh is not None]


def filled(mesh, cells=40):
    low, high = mesh.bounds
    spacing = float((high - low).max()) / (cells - 8)
    return occupancy((mesh.corners - (low + high) / 2) / spacing + cells / 2, (cells,) * 3)


def test_tears_are_repaired():
    """No frame has more pieces or handles than a horse or a bird."""
    shapes = animals()
    torn = [piece_count(frame.mesh) for frame in frames_of(shapes, 4, PLAIN)]
    assert max(torn) > 2
    for frame in frames_of(shapes, 4, MorphSettings(motion="transport", resolution=40)):
        found = topology(frame.mesh)
        assert found.closed
        assert (piece_count(frame.mesh), found.euler) == (1, 2)
        assert frame.record["found"] == {"pieces": 1, "handles": 0, "bubbles": 0}
        assert frame.mesh.volume == pytest.approx(frame.record["volume_wanted"], rel=5e-3)


def test_what_is_beyond_all_limits_is_not_limited():
    """A thin bar that has moved by several times its width."""
    bars = [box((20.0, 2.0, 2.0), (20.0, 20.0, height)) for height in (10.0, 30.0)]
    density = occupancy(bars[0].corners, (40, 40, 40))
    constraint = Constraint(bounds=SurfaceBounds.of(bars[1].corners, density.shape, 3.0))
    connectivity = [Connectivity(1, 0, 0)]
    found = extract_surface(density, 80.0, 1.0, connectivity, MorphSettings(thin_parts=False), constraint=constraint)
    assert found.surface.mesh.volume == pytest.approx(80.0, rel=0.01)
    assert (found.record["held"], found.record["held_share"]) == (80, 1.0)


def test_a_blend_may_have_the_holes_of_one_shape():
    pair = joined(ball(0.5, (-0.8, 0, 0)), ball(0.5, (0.8, 0, 0)))
    for frame in frames_of([pair, torus()], 4, MorphSettings(motion="transport", resolution=32)):
        assert frame.record["found"]["pieces"] <= 2
        assert frame.record["found"]["handles"] <= 1
    first, *_ = frames_of([pair, torus()], 8, MorphSettings(motion="transport", resolution=32))
    assert first.record["found"]["pieces"] == 2


def test_thin_legs_keep_their_volume():
    """The same table, one taller: the legs of the blend are legs of a height between, as thick as before."""

    def table(height):
        legs = [box((0.1, 0.1, height), (x, y, -height / 2)) for x in (-0.8, 0.8) for y in (-0.8, 0.8)]
        return joined(box((2.0, 2.0, 0.5), (0, 0, 0.2)), *legs)

    def below(mesh):
        """Volume of the lowest 0.5 of a mesh: slices of the legs, four of 0.01."""
        cells = 80
        low, high = mesh.bounds
        spacing = float((high - low).max()) / (cells - 8)
        inside = occupancy((mesh.corners - (low + high) / 2) / spacing + cells / 2, (cells,) * 3)
        bottom = round((low[2] - (low + high)[2] / 2) / spacing + cells / 2)
        start, stop = bottom + round(0.15 / spacing), bottom + round(0.65 / spacing)
        return float(inside[:, :, start:stop].sum()) * spacing**3 / ((stop - start) * spacing)

    shapes = [table(1.0), table(1.4)]
    thin = MorphSettings(motion="transport", resolution=64)
    for frame in frames_of(shapes, 2, thin):
        assert below(frame.mesh) == pytest.approx(0.04, rel=0.15)
    for frame in frames_of(shapes, 2, dataclasses.replace(thin, thin_parts=False)):
        assert below(frame.mesh) < 0.034


def test_connectivity_of_shapes():
    settings = MorphSettings(motion="transport", resolution=40)
    assert connectivity_of(filled(torus()), settings) == Connectivity(1, 1, 0)
    two = joined(ball(0.5, (-0.8, 0, 0)), ball(0.5, (0.8, 0, 0)))
    assert connectivity_of(filled(two), settings) == Connectivity(2, 0, 0)


@pytest.mark.parametrize("changes", [{}, {"mend": False}, {"thin_parts": False}, {"level": "half-max"}])
def test_records_contain_found_and_lost_parts(changes):
    density = filled(ball()).astype(float)
    settings = MorphSettings(motion="transport", resolution=40, **changes)
    extracted = extract_surface(density, float(density.sum()), 1.0, [Connectivity(1, 0, 0)], settings)
    record = json.loads(json.dumps(extracted.record))
    assert record["found"] == {"pieces": 1, "handles": 0, "bubbles": 0}
    assert record["lost"]["share"] == 0
    assert ("mended" in record) == (settings.mend and settings.level == "volume")
