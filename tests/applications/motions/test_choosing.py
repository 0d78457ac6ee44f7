# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The choice of a motion for a whole request; the motions themselves have their own tests."""

from functools import partial

import numpy as np
import pytest

from convwass_addon.applications.motions import choosing, motion_candidates
from convwass_addon.applications.motions.choosing import chosen_motion
from convwass_addon.applications.motions.motion_choice import MotionChoice
from convwass_addon.applications.motions.motion_request import MotionRequest
from convwass_addon.errors import InputError, ResourceError
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.solids import outer_skin
from convwass_addon.progress import UNINTERRUPTED, drained
from tests.applications.maps import coarse_maps
from tests.applications.motions.given_motions import BARBELL, SHAPES, WARP, chosen_by, give, guided_with
from tests.shapes import ball, box, joined, renumbered

BOXES = joined(box(), box((0.2, 1.0, 1.0), (2.0, 0.0, 1.0)), box((0.2, 0.2, 2.0), (0.0, 2.0, 0.0)))
OVERLAPPING = joined(box(), box((0.3, 0.3, 2.0), (0.3, 0.3, 1.0)), box((0.3, 2.0, 0.3), (-0.3, 1.0, -0.3)))


@pytest.fixture
def motions(monkeypatch):
    # The balls of a barbell lie apart.
    monkeypatch.setattr(choosing.SeparateBodies, "of", lambda request: None)
    return partial(give, monkeypatch)


choice = partial(chosen_by, chosen_motion)


def test_motions_are_computed_with_one_thread_of_blas(monkeypatch):
    # Threads of BLAS that wait for each other multiply the time of a warp, and decide on the last digits.
    threadpoolctl = pytest.importorskip("threadpoolctl")
    found = []

    def warped(*_arguments, **_options):
        libraries = threadpoolctl.threadpool_info()
        found.extend(library["num_threads"] for library in libraries if library["user_api"] == "blas")
        return WARP
        yield

    monkeypatch.setattr(motion_candidates, "warp_motion", warped)
    with threadpoolctl.threadpool_limits(2, user_api="blas"):
        drained(chosen_motion(MotionRequest(SHAPES, ("a", "b"), [(0, 1)], "warp", 0.5), UNINTERRUPTED))
    assert set(found) == {1}


def test_a_requested_motion_is_computed_or_refused(motions):
    motions(guided_with(0.1))
    assert [choice(kind).kind for kind in ("guided", "warp", "transport")] == ["guided", "warp", "transport"]
    motions(InputError("no map"))
    with pytest.raises(InputError, match="no map"):
        choice("guided")


def test_equal_shapes_without_limbs_need_no_map():
    round_ = ball(points=200)
    egg = TriangleMesh(round_.vertices * (1.0, 2.0, 3.0), round_.faces)
    with coarse_maps():
        found = choice(shapes=(egg, renumbered(egg.moved((3.0, 1.0, 0.0))))).record()
    assert found == {"kind": "warp", "reason": "SOLID", "left": 0.0}


@pytest.mark.parametrize(
    ("limbed", "crumpling", "bends"),
    [(BOXES, 1.3, True), (OVERLAPPING, 1.3, True), (BOXES, 1.2, False), (BARBELL, 1.3, False)],
    ids=["bent", "overlapping", "little", "round"],
)
def test_plane_faces_are_transported_rather_than_bent(motions, monkeypatch, limbed, crumpling, bends):
    motions(guided_with(0.6), by_warp_alone=0.1)
    monkeypatch.setattr(motion_candidates.MotionCandidates, "warp_crumpling", lambda *_arguments: crumpling)
    found = choice(shapes=(limbed, box((1.0, 2.0, 3.0))))
    assert (found.kind, found.reason) == (("transport", "BENT") if bends else ("warp", "SOLID"))
    assert found.left == (None if bends else 0.1)
    assert choice("warp", shapes=(limbed, box())).motion is WARP


def test_a_warp_that_would_replace_a_map_is_not_used_if_it_bends(motions, monkeypatch):
    motions(guided_with(0.6, crumpling=1.9), left=0.6, by_warp_alone=0.1)
    shapes = (BOXES, renumbered(BOXES.moved((0.0, 1.0, 0.0))))
    monkeypatch.setattr(motion_candidates.MotionCandidates, "warp_crumpling", lambda *_arguments: 1.2)
    assert choice(shapes=shapes).kind == "warp"
    monkeypatch.setattr(motion_candidates.MotionCandidates, "warp_crumpling", lambda *_arguments: 1.4)
    assert choice(shapes=shapes).record() == {
        **{"kind": "transport", "reason": "BENT", "score": 0.6, "detour": 1.0},
        "left": 0.1,
    }


def test_if_a_coarse_warp_fails_the_complete_one_tells(motions, monkeypatch):
    motions(guided_with(0.6), warp=ResourceError("no memory"))
    found = choice(shapes=(BOXES, box((1.0, 2.0, 3.0))))
    assert (found.kind, found.reason, found.failure) == ("transport", "FAILED", "no memory")


def test_outlines_move_shapes_that_they_determine_unless_there_are_guides_or_a_warp_is_asked_for(motions):
    motions(guided_with(0.95), by_warp_alone=0.1)
    pair = box((1.0, 2.0, 0.3)), box((2.0, 1.0, 0.5))
    assert choice(shapes=pair).reason == "OUTLINES"
    assert choice("guided", shapes=pair).motion is not None
    assert choice("warp", shapes=pair).motion is WARP
    assert choice(shapes=pair, guides=[{0: 7, 1: 7}]).reason == "FITS"


@pytest.mark.parametrize("options", [{}, {"kind": "guided"}, {"guides": [{0: 7, 1: 7}]}])
def test_shapes_turn_only_automatically_and_without_guides(motions, monkeypatch, options):
    asked = []
    monkeypatch.setattr(choosing.Turning, "of", lambda *arguments: asked.append(arguments))
    motions(guided_with(0.95))
    choice(shapes=(ball(points=200), box((1.0, 2.0, 3.0))), **options)
    assert bool(asked) == (not options)


def test_if_outlines_fail_the_surfaces_are_mapped(motions, monkeypatch):
    def failing(*_arguments):
        raise np.linalg.LinAlgError("singular")

    motions(guided_with(0.95))
    monkeypatch.setattr(choosing, "extruded_motion", failing)
    assert choice("guided", shapes=(box(), box((2.0, 1.0, 1.0)))).score == 0.95


@pytest.mark.parametrize(
    ("outside", "apart", "used"),
    [
        (0.6, 0.2, "apart"),
        (0.6, 0.4, "outside"),
        (0.2, 0.05, "outside"),
        (None, 0.1, "outside"),
        (0.6, None, "outside"),
    ],
)
def test_overlapping_bodies_are_mapped_as_they_are_if_that_leaves_much_less(monkeypatch, outside, apart, used):
    one, other = (joined(box((1.0, 2.0, 0.3)), ball(0.6, (0.0, shift, 0.3), points=60)) for shift in (0.0, 0.5))
    shapes = one, renumbered(other)

    def by_surfaces(request, _control):
        kind, left = ("apart", apart) if request.shapes is shapes else ("outside", outside)
        return MotionChoice("guided", "PARTLY", kind, left=left)
        yield

    monkeypatch.setattr(outer_skin, "_CELLS", 32)
    monkeypatch.setattr(choosing, "motion_of_surfaces", by_surfaces)
    monkeypatch.setattr(choosing, "following", lambda motion, *_shapes: motion)
    assert choice(shapes=shapes).motion == used


@pytest.mark.parametrize(("size", "used"), [(0.2, "outside"), (0.8, "apart")])
def test_bodies_with_small_ones_are_mapped_once(monkeypatch, size, used):
    """Unless the other shape has two large ones."""
    eye, other = (ball(radius, (0.9, 0.1, 0.3), points=60) for radius in (0.2, size))
    shapes = joined(ball(1.0, points=200), eye), renumbered(joined(ball(1.0, points=200), other))

    def by_surfaces(request, _control):
        kind, left = ("apart", 0.1) if request.shapes is shapes else ("outside", 0.9)
        return MotionChoice("guided", "PARTLY", kind, left=left)
        yield

    monkeypatch.setattr(outer_skin, "_CELLS", 32)
    monkeypatch.setattr(choosing, "motion_of_surfaces", by_surfaces)
    monkeypatch.setattr(choosing, "following", lambda motion, *_shapes: motion)
    assert choice(shapes=shapes).motion == used


def test_without_an_outer_surface_bodies_are_mapped_as_they_are(motions, monkeypatch):
    def failing(*_arguments):
        raise ValueError("not a number")

    motions(guided_with(0.95))
    monkeypatch.setattr(choosing, "with_skins", failing)
    assert choice().score == 0.95


def test_without_coherence_there_is_no_motion(motions):
    motions(AssertionError("must not be asked for"))
    assert choice(coherence=0.0).kind == "transport"
