# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How often pieces and handles change on the way between shapes whose topology is known."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.frame_cache import FrameCache
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph import morph
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_problem import MorphFrame
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.motions import motion_candidates
from convwass_addon.applications.motions.motion_choice import MotionChoice
from convwass_addon.applications.motions.motion_memory import MotionMemory
from convwass_addon.applications.motions.warp_motion import WarpEffort
from convwass_addon.errors import Cancelled
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import Control, payloads
from tests.shapes import ball, box, joined, torus
from tests.stored_frames import assert_as_stored

BLENDS = path_blends(2, 12)


def turned(mesh):
    return TriangleMesh(Rotation.from_euler("y", 90, degrees=True).apply(mesh.vertices), mesh.faces)


def window():
    """Five bars with two openings between them."""
    across = [box((2.0, 0.3, 0.3), (0, y, 0)) for y in (-0.8, 0.0, 0.8)]
    return joined(*across, *[box((0.3, 1.9, 0.3), (x, 0, 0)) for x in (-0.85, 0.85)])


def made(shapes, resolution, motion="transport", **how):
    """All frames as they come; some come twice."""
    settings = MorphSettings(motion=motion, resolution=resolution)
    steps = morph(MorphInputs.of(shapes, ["a", "b"]), BLENDS, settings, computation=Computation(**how))
    return list(payloads(steps, MorphFrame))


def final(frames):
    """The last frame of every blend."""
    return list({frame.blend: frame for frame in frames}.values())


def counts(frames, kind):
    """The final count of every blend."""
    return [frame.record["found"][kind] for frame in final(frames)]


def changes(values):
    return sum(abs(after - before) for before, after in pairwise(values))


def test_two_spheres_that_touch_part_once():
    touching, apart = (joined(ball(0.7, (-x, 0, 0)), ball(0.7, (x, 0, 0))) for x in (0.69, 1.2))
    pieces = counts(made((touching, apart), 24), "pieces")
    assert (pieces[0], pieces[-1], changes(pieces)) == (1, 2, 1)


def test_the_hole_of_a_torus_closes_once_on_the_way_to_a_ball():
    frames = made((torus(1.0, 0.35), ball(0.9)), 24)
    handles = counts(frames, "handles")
    assert (handles[0], handles[-1], changes(handles)) == (1, 0, 1)
    assert counts(frames, "pieces") == [1] * len(BLENDS)


def thickness(mesh):
    """Height of a mesh on the z axis; zero with a hole there."""
    near = mesh.vertices[np.hypot(*mesh.vertices[:, :2].T) < 0.12]
    return float(np.ptp(near[:, 2])) if len(near) else 0.0


class Unmapped(MotionMemory):
    """A choice of transport without the search for a map."""

    def chosen(self, request, control):
        yield from ()
        return MotionChoice("transport", "SOLID")


def falls(frames, first=1.8):
    """By how much the thickness falls from blend to blend, first from that of a ball."""
    return -np.diff([first, *(thickness(frame.mesh) for frame in frames if frame.mesh is not None)])


def test_a_hole_that_opens_at_once_is_dug_from_both_sides():
    """In the barycenters, the middle of the ball is gone within a frame; by transport alone, it stays so."""
    shapes = (ball(0.9), torus(1.0, 0.35))
    frames = made(shapes, 32, motion="automatic", motions=Unmapped())
    assert falls(frames[: len(BLENDS)]).max() > 1.5
    assert falls(final(frames)).max() < 0.45
    assert falls(final(made(shapes, 32))).max() > 1.5


def test_a_hole_that_opens_between_warped_shapes_is_dug_from_both_sides(monkeypatch):
    monkeypatch.setattr(motion_candidates, "USUAL_EFFORT", WarpEffort(32, 6))
    frames = made((ball(1.1), torus(1.0, 0.35)), 32, motion="warp")
    assert 0.45 < falls(frames[: len(BLENDS)], 2.2).max() < 0.6
    assert falls(final(frames), 2.2).max() < 0.45
    handles = counts(frames, "handles")
    assert (handles[0], handles[-1], changes(handles)) == (0, 1, 1)


@pytest.fixture(scope="module")
def flickering(tmp_path_factory):
    """A window that becomes a ring: if blends are independent, its second opening closes, opens and closes."""
    shapes = (window(), turned(torus(1.0, 0.3)))
    cache = FrameCache(tmp_path_factory.mktemp("cache"))
    return shapes, made(shapes, 21, cache=cache), cache


def test_a_hole_that_flickers_closes_once(flickering):
    _, frames, _ = flickering
    by_themselves, together = (counts(own, "handles") for own in (frames[: len(BLENDS)], frames))
    assert changes(by_themselves) > 1
    assert (together[0], together[-1], changes(together)) == (2, 1, 1)
    again = frames[len(BLENDS) :]
    assert all(frame.record["most"]["handles"] == 2 for frame in again)


def test_revised_frames_are_the_same_from_the_cache_and_other_processes(flickering):
    shapes, expected, cache = flickering
    reused = cache.reused
    from_cache = made(shapes, 21, cache=cache)
    assert cache.reused - reused == len(list(cache.folder.iterdir())) >= len(expected)
    with ThreadPoolExecutor(2) as executor:
        elsewhere = made(shapes, 21, executor=executor)
    for found in (from_cache, elsewhere):
        assert [frame.blend for frame in found] == [frame.blend for frame in expected]
        for one, other in zip(found, expected, strict=True):
            assert_as_stored(one, other)


def test_a_part_of_a_bake_is_not_revised(flickering):
    shapes, expected, cache = flickering
    part = made(shapes, 21, cache=cache, wanted=range(len(BLENDS)))
    assert [frame.blend for frame in part] == [frame.blend for frame in expected[: len(BLENDS)]]


def test_a_bake_can_be_stopped_during_the_revision(flickering):
    shapes, expected, _ = flickering
    control = Control()
    inputs, settings = MorphInputs.of(shapes, ["a", "b"]), MorphSettings(motion="transport", resolution=21)
    steps = payloads(morph(inputs, BLENDS, settings, control), MorphFrame)
    with pytest.raises(Cancelled):
        for count, _ in enumerate(steps, start=1):
            if count == len(BLENDS):
                control.cancel()
    assert count == len(BLENDS) < len(expected)


def test_repairs_that_raise_the_level_above_the_density_do_not_end_a_bake():
    """At 20 cells, the bars of the window are so thin that closing one opening moves the whole surface."""
    handles = counts(made((window(), turned(torus(1.0, 0.3))), 20), "handles")
    assert (handles[0], handles[-1]) == (2, 1)
