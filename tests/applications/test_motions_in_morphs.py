# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whole morphs with a motion, from meshes to frames."""

import numpy as np
import pytest

from convwass_addon.applications.morphs.bake_plan import MorphPreview
from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.frame_cache import FrameCache
from convwass_addon.applications.morphs.layouts import pairs_of, path_blends
from convwass_addon.applications.morphs.morph import morph
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_problem import MorphFrame
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.motions import motion_memory
from convwass_addon.applications.motions.motion_choice import MotionChoice
from convwass_addon.errors import InputError
from convwass_addon.geometry.meshes.edges import topology
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import drained
from tests.applications.maps import arm, coarse_maps
from tests.shapes import ball, shuffled, torus
from tests.stored_frames import assert_as_stored

NAMES = ("down", "up")


def baked(shapes, settings, guides=(), **how):
    inputs = MorphInputs.of(shapes, NAMES, guides=guides)
    work = morph(inputs, path_blends(2, 4), settings, computation=Computation(**how))
    reports = list(work)
    return [one.payload for one in reports if isinstance(one.payload, MorphFrame)], reports


@pytest.fixture(scope="module")
def arms():
    return arm(0.0, 12, 30)[0], shuffled(arm(np.radians(100.0), 12, 30)[0])[0]


@pytest.fixture(scope="module")
def guided(arms, tmp_path_factory):
    cache = FrameCache(tmp_path_factory.mktemp("frames"))
    settings = MorphSettings(resolution=24)
    with coarse_maps():
        return baked(arms, settings, previews=True, cache=cache), settings, cache


def test_automatic_chooses_a_guided_motion_for_an_arm(guided, arms):
    (frames, _), _, _ = guided
    assert [frame.record["motion"]["kind"] for frame in frames] == ["guided"] * 5
    assert frames[2].record["motion"]["reason"] == "FITS"
    assert frames[2].record["motion"]["score"] > 0.6


def test_motions_are_found_for_shapes_whose_seams_are_closed(monkeypatch):
    """Guides on a seam are on the vertex that is left."""
    requests = []

    def chosen(request, _control):
        requests.append(request)
        return MotionChoice("transport", "APART")
        yield

    monkeypatch.setattr(motion_memory, "chosen_motion", chosen)
    ring = torus()
    apart = TriangleMesh(ring.corners.reshape(-1, 3), np.arange(3 * len(ring.faces)).reshape(-1, 3))
    guides = [{0: len(apart.vertices) - 1, 1: int(ring.faces[-1, 2])}]
    drained(morph(MorphInputs.of((apart, ring), NAMES, guides=guides), path_blends(2, 2), MorphSettings(resolution=16)))
    (request,) = requests
    assert [topology(shape).closed for shape in request.shapes] == [True, True]
    assert request.shapes[0].volume == pytest.approx(ring.volume)
    assert request.guides[0][0] in request.shapes[0].faces
    place = request.shapes[0].vertices[request.guides[0][0]]
    assert place == pytest.approx(ring.vertices[request.guides[0][1]])


def test_the_arm_stays_in_one_piece_and_as_long(guided, arms):
    (frames, _), _, _ = guided
    for frame in frames[1:4]:
        assert frame.record["found"] == {"pieces": 1, "handles": 0, "bubbles": 0}
        assert frame.mesh.volume == pytest.approx(arms[0].volume, rel=0.02)
        assert frame.mesh.area == pytest.approx(arms[0].area, rel=0.08)


def test_previews_come_before_the_frames(guided):
    (_, reports), _, _ = guided
    kinds = [type(one.payload) for one in reports if one.payload is not None]
    assert kinds.index(MorphPreview) < kinds.index(MorphFrame)
    assert sum(kind is MorphPreview for kind in kinds) >= 3


def test_frames_come_back_from_the_cache_with_their_tangents(guided, arms):
    (frames, _), settings, cache = guided
    again, _ = baked(arms, settings, cache=cache)
    assert cache.reused == len(frames)
    for one, other in zip(frames[1:4], again[1:4], strict=True):
        assert other.tangents is not None
        assert_as_stored(other, one)


def test_guides_make_another_bake(guided, arms):
    _, settings, cache = guided
    inputs = [MorphInputs.of(arms, NAMES, guides=guides) for guides in ((), [{0: 1, 1: 2}])]
    digests = {cache.of(own, settings).paths(path_blends(2, 4)[:1])[0] for own in inputs}
    assert len(digests) == 2


def test_coherence_zero_is_transport(arms):
    frames, _ = baked(arms, MorphSettings(resolution=24, coherence=0.0, carry=False))
    assert frames[1].record["motion"] == {"kind": "transport", "reason": "ASKED"}


def test_a_failing_guided_motion_is_refused_and_automatic_continues():
    shapes = (ball(points=60), torus())
    with pytest.raises(InputError, match="in 2 pairs"):
        baked(shapes, MorphSettings(resolution=24, motion="guided"), guides=[{0: 3, 1: 5}, {0: 3, 1: 9}])


def test_pairs_are_those_that_occur_together():
    assert pairs_of(path_blends(3, 4)) == [(0, 1), (1, 2)]
