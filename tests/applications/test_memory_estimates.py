# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Memory estimates of bakes: never below the measured peak, and not several times above it."""

from __future__ import annotations

import tracemalloc
from dataclasses import replace

import pytest

from convwass_addon.applications.flat.flat_morph import flat_morph
from convwass_addon.applications.flat.flat_problem import flat_problem, pieces_of
from convwass_addon.applications.flat.flat_settings import FlatSettings
from convwass_addon.applications.flat.flat_shapes import FlatShape
from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.memory_needs import estimated_bytes
from convwass_addon.applications.morphs.morph import morph
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.morphs.volumes import Lattice
from convwass_addon.progress import drained
from tests.flat_shapes import ellipse
from tests.shapes import ball, box, torus

BLENDS = path_blends(2, 4)


def peak_of(work, settings):
    """Return the peak of a second run, which excludes imports and caches of the first, a coarser one."""
    drained(work(replace(settings, resolution=settings.resolution // 2)))
    tracemalloc.start()
    drained(work(settings))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return peak


@pytest.mark.parametrize("shapes", [[ball(), box()], [torus(1.0, 0.2), box((2.0, 0.3, 0.3))]], ids=["full", "slender"])
def test_of_solids(shapes):
    settings = MorphSettings(motion="transport", resolution=64)
    lattice = Lattice.around(shapes, settings.resolution, settings.sigma)
    inputs = MorphInputs.of(shapes, ["a", "b"])
    peak = peak_of(lambda own: morph(inputs, BLENDS, own, computation=Computation(1)), settings)
    assert 0.3 < peak / lattice.memory(shapes, 1, 1) < 1.0


@pytest.mark.parametrize("shapes", [[ball(), box()], [torus(1.0, 0.2), box((2.0, 0.3, 0.3))]], ids=["full", "slender"])
def test_before_shapes_are_read(shapes):
    sizes = [shape.bounds[1] - shape.bounds[0] for shape in shapes]
    needed = Lattice.around(shapes, 128, 1.0).memory(shapes, 2, 1)
    assert 0.5 < estimated_bytes(sizes, 128, 2) / needed < 2.0


def test_of_flat_shapes():
    shapes = [FlatShape((ellipse(radii=radii),)) for radii in ((1.0, 1.0), (0.5, 1.5))]
    settings = FlatSettings(resolution=256, motion="transport")
    lattice = flat_problem(shapes, pieces_of(shapes, ["a", "b"], settings), ["a", "b"], settings).lattice
    peak = peak_of(lambda own: flat_morph(shapes, ["a", "b"], BLENDS, own, workers=1), settings)
    assert 0.3 < peak / lattice.memory(2, 1) < 1.0
