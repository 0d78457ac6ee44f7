# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sheets beside solids, such as fins and wings, in morphs."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.morphs.animation import Animation, ShapeAnimation
from convwass_addon.applications.morphs.between_frames import between_frames
from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.frame_cache import FrameCache
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph import morph
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_problem import MorphFrame
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.morphs.part_labels import Matching
from convwass_addon.applications.morphs.plated_shapes import with_plates
from convwass_addon.geometry.meshes.closest_points import ClosestPointFinder
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import payloads
from tests.grids import sheet
from tests.shapes import ball, joined, turned

CELLS = 40
BODY = ball(0.5, points=600)


def finned(length):
    """A ball with a bent fin, whose root is in the ball."""
    flat = sheet(17, 13)
    x, z = flat.vertices[:, 0], flat.vertices[:, 1] - 0.5
    fin = TriangleMesh(np.stack([0.4 + length * x, 0.1 * x**2, z], axis=1), flat.faces)
    return joined(BODY, fin)


def middle_of(shapes, animation=None, **settings):
    names = [f"shape {index}" for index in range(len(shapes))]
    inputs = MorphInputs.of(shapes, names, animation=animation)
    steps = morph(inputs, path_blends(len(shapes), 2), MorphSettings(CELLS, **settings))
    found = {frame.blend.frame: frame for frame in payloads(steps, MorphFrame)}
    return found[1].mesh


def farthest(mesh, points):
    """The largest distance of some points from a mesh, in cells of the shapes."""
    return ClosestPointFinder(mesh.corners).find(points).distances.max() * CELLS / finned(1.2).longest_side


def test_a_fin_stays_whole_on_the_way():
    """It was in shreds, and shorter by several cells."""
    mesh = middle_of([finned(0.8), finned(1.2)])
    expected = finned(1.0)
    fin = expected.corners[len(BODY.faces) :].mean(axis=1)
    assert farthest(mesh, fin) < 2.0
    # The fin is two cells thick.
    assert farthest(expected, mesh.vertices) < 2.5


def test_a_fin_follows_an_animated_shape():
    poses = [
        ShapeAnimation((0.0, 2.0), tuple(turned(finned(length), angle) for angle in (0.0, 0.8)))
        for length in (0.8, 1.2)
    ]
    mesh = middle_of([pose.meshes[0] for pose in poses], Animation(tuple(poses), (0.0, 2.0)))
    # The vertices of animated shapes move along straight lines.
    fins = [pose.at(1.0).vertices[len(BODY.vertices) :] for pose in poses]
    assert farthest(mesh, 0.5 * (fins[0] + fins[1])) < 2.5


def test_a_fin_stays_whole_between_frames(tmp_path):
    """Blends between those of a path are solved from its kept frames, which have the fin."""
    shapes, settings = [finned(0.8), finned(1.2)], MorphSettings(CELLS, motion="transport")
    inputs = MorphInputs.of(shapes, ["a", "b"])
    steps = between_frames(inputs, path_blends(2, 2), [1.5], settings, Computation(2, cache=FrameCache(tmp_path)))
    (frame,) = payloads(steps, MorphFrame)
    expected = finned(1.1)
    assert farthest(frame.mesh, expected.corners[len(BODY.faces) :].mean(axis=1)) < 2.0


def test_parts_include_plates():
    shape = finned(1.0)
    parts = np.repeat([0, 1], [len(BODY.faces), len(shape.faces) - len(BODY.faces)])
    matching = Matching(("body", "fin"), (parts, np.full(len(BODY.faces), 2)))
    plated = with_plates(MorphInputs([shape, BODY], ["a", "b"], matching), MorphSettings(CELLS))
    volumes = np.bincount(plated.matching.faces[0], plated.shapes[0].face_volumes)
    thickness = 2.0 * shape.longest_side / CELLS
    fin = TriangleMesh(shape.vertices, shape.faces[len(BODY.faces) :])
    np.testing.assert_allclose(volumes, [BODY.volume, thickness * fin.area], rtol=0.02)
    assert plated.shapes[1] is BODY


def test_plates_get_the_thickness_of_the_settings():
    plated = with_plates(MorphInputs.of([finned(1.0)], ["a"]), MorphSettings(CELLS, thickness=0.2))
    fin = TriangleMesh(finned(1.0).vertices, finned(1.0).faces[len(BODY.faces) :])
    assert plated.shapes[0].volume == pytest.approx(BODY.volume + 0.2 * fin.area, rel=0.01)
