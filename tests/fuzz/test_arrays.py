# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Broken meshes, curves and images in every application: the result is finite, or there is a message."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.skeletons import skeleton_bodies
from convwass_addon.errors import Cancelled, InputError
from convwass_addon.geometry.meshes.edges import topology
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from tests.controls import CountingControl
from tests.fuzz.array_cases import (
    ON_MESHES,
    ON_PIXELS,
    ON_RINGS,
    density_of,
    flat_of,
    gray_of,
    morph_of,
    outcome,
    palette_of,
    skeleton_of,
    soft_map_of,
)
from tests.fuzz.corpus import broken_images, broken_meshes, broken_rings
from tests.shapes import ball

# Shapes that every application must refuse; others may use what is valid.
NEVER = {"nothing", "points", "one point thrice", "one vertex thrice", "NaN", "infinite", "beyond"}
# The campaign of `python3 run.py fuzz` tries all combinations; slow applications are tried only on these here.
_SOME = ("needle", "tiny", "flat", "moebius", "loose")
TRIED = {kind: (*sorted(NEVER), *_SOME) for kind in ("armature", "soft map")}
# Rings with a well-defined area; all others must be refused.
SOUND_RINGS = {"star", "doubled", "bow", "repeated corners", "scribble", "many", "far"}
_SOME_PIXELS = ("one pixel", "nothing", "clear", "one color", "all NaN", "all infinite", "one NaN", "alpha infinite")


@pytest.mark.parametrize("kind", ON_MESHES)
def test_broken_meshes(kind):
    for name, make in broken_meshes().items():
        if name not in TRIED.get(kind, [name]):
            continue
        found = outcome(lambda make=make: ON_MESHES[kind](TriangleMesh.from_arrays(*make())))
        assert found == "refused" or name not in NEVER, name


def test_broken_rings():
    found = {name: outcome(lambda rings=rings: ON_RINGS["flat"](rings)) for name, rings in broken_rings()}
    assert {name for name, what in found.items() if what == "done"} == SOUND_RINGS


@pytest.mark.parametrize("kind", ON_PIXELS)
def test_broken_images(kind):
    tried = {name: pixels for name, pixels in broken_images() if kind != "recolor" or name in _SOME_PIXELS}
    found = {name: outcome(lambda pixels=pixels: ON_PIXELS[kind](pixels)) for name, pixels in tried.items()}
    assert found["nothing"] == found["all NaN"] == found["all infinite"] == "refused"


@pytest.mark.parametrize("kind", ["morph", "soft map", "armature"])
@pytest.mark.parametrize("name", ["huge", "largest", "beyond"])
def test_coordinates_whose_squares_overflow_are_refused(kind, name):
    mesh = TriangleMesh.from_arrays(*broken_meshes()[name]())
    with pytest.raises(InputError, match=r"farther away than 1e\+18"):
        ON_MESHES[kind](mesh)


def test_very_complex_meshes_use_larger_cells(monkeypatch):
    """A mesh of 120 random triangles has hundreds of handles, which no reduction removes."""
    mesh = TriangleMesh.from_arrays(*broken_meshes()["scrambled"]())
    monkeypatch.setattr(skeleton_bodies, "RESOLUTION", 64)
    handles = []
    for most in (100, 1000):
        monkeypatch.setattr(skeleton_bodies, "MOST_HANDLES", most)
        body = skeleton_bodies.skeleton_body(mesh, mesh.bounds.mean(axis=0)[None], ("middle",))
        found = topology(body.surface)
        assert found.closed
        handles.append((2 - found.euler) // 2)
    assert handles[0] < 100 < handles[1]


def pixels():
    return np.random.default_rng(0).random((8, 9, 4))


JOBS = {
    "morph": lambda control: morph_of(ball(points=60), control),
    "density": lambda control: density_of(ball(points=60), control),
    "soft map": lambda control: soft_map_of(ball(points=60), control),
    "armature": lambda control: skeleton_of(ball(points=60), control),
    "flat": lambda control: flat_of([np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)])], control),
    "gray": lambda control: gray_of(pixels(), control),
    "recolor": lambda control: palette_of(pixels(), control),
}


@pytest.mark.parametrize("name", JOBS)
def test_jobs_can_be_cancelled_at_every_check(name):
    """Every check ends the job after Esc was pressed, and nothing swallows the exception."""
    whole = CountingControl()
    JOBS[name](whole)
    assert whole.count, "it never checks for cancellation"
    for last in sorted({1, 2, whole.count // 3 + 1, whole.count} & set(range(1, whole.count + 1))):
        with pytest.raises(Cancelled):
            JOBS[name](CountingControl(last))
