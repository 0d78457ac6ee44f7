# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Uncertain maps: used, completed by a warp, or given up."""

from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest

from convwass_addon.applications.motions import motion_candidates
from convwass_addon.applications.motions.surface_choice import motion_of_surfaces
from convwass_addon.applications.motions.warp_motion import USUAL_EFFORT
from convwass_addon.errors import ResourceError
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from tests.applications.motions.given_motions import (
    BARBELL,
    FADED,
    SHAPES,
    WARP,
    chosen_by,
    give,
    guided_with,
    unless_guided,
    work_of,
)
from tests.shapes import box, joined


@pytest.fixture
def motions(monkeypatch):
    return partial(give, monkeypatch)


choice = partial(chosen_by, motion_of_surfaces)


def test_maps_that_make_detours_are_not_completed_by_a_warp(motions):
    motions(guided_with(0.6, detour=1.8), combined=AssertionError("must not be asked for"))
    assert choice().record() == {"kind": "guided", "reason": "PARTLY", "score": 0.6, "detour": 1.8, "left": 0.4}


@pytest.mark.parametrize(
    ("left", "by_warp_alone", "kind"), [(0.5, 0.1, "guided"), (0.6, 0.1, "warp"), (0.6, 0.7, "transport")]
)
def test_maps_that_make_detours_and_leave_most_are_given_up(motions, left, by_warp_alone, kind):
    """Unless guides say what corresponds."""
    motions(guided_with(0.6, detour=1.8), left=left, by_warp_alone=by_warp_alone)
    found = choice()
    assert (found.kind, found.reason) == (kind, "PARTLY" if kind == "guided" else "APART")
    assert choice(guides=[{0: 7, 1: 7}]).kind == "guided"


@pytest.mark.parametrize("score", [0.3, 0.6])
@pytest.mark.parametrize(("left", "kind"), [(0.75, "guided"), (0.8, "transport")])
def test_maps_that_leave_nearly_all_are_given_up(motions, score, left, kind):
    """Unless a warp is better, or guides say what corresponds."""
    motions(guided_with(score), left=left, by_coarse=1.0, by_warps=0.9)
    found = choice()
    assert (found.kind, found.reason, found.left) == (kind, "PARTLY" if kind == "guided" else "APART", left)
    assert choice(guides=[{0: 7, 1: 7}]).kind == "guided"
    motions(guided_with(score), left=left, by_coarse=1.0, by_warps=0.9, by_warp_alone=0.3)
    assert choice().kind == "warp"


def test_a_map_that_leaves_nearly_all_is_given_up_if_a_warp_fails(motions):
    motions(guided_with(0.6), left=0.8, combined=ResourceError("no memory"))
    found = choice()
    assert (found.kind, found.left, found.failure) == ("transport", 0.8, "no memory")


def test_maps_that_make_detours_are_kept_if_what_they_leave_cannot_be_measured(motions, monkeypatch):
    motions(guided_with(0.6, detour=1.8))
    monkeypatch.setattr(motion_candidates, "remaining_share", unless_guided)
    assert choice().record() == {"kind": "guided", "reason": "PARTLY", "score": 0.6, "detour": 1.8}


def test_shapes_that_divide_far_away_are_transported(motions):
    """Unless guides say what corresponds."""
    pair = (BARBELL, joined(BARBELL, BARBELL.moved((0.0, 0.0, 8.0))))
    motions(guided_with(0.6, detour=1.8))
    apart = {"reason": "APART", "score": 0.6, "detour": 1.8}
    assert choice(shapes=pair).record() == {"kind": "transport", **apart, "left": 0.7}
    assert choice(shapes=pair, guides=[{0: 7, 1: 7}]).kind == "guided"
    motions(guided_with(0.6), left=0.1)
    assert choice(shapes=pair).kind == "guided"


@pytest.mark.parametrize(("score", "kind"), [(0.59, "warp"), (0.6, "guided")])
def test_maps_by_which_shapes_tumble_are_given_up_unless_they_are_good(motions, score, kind):
    """Or unless guides say what corresponds; how little is left does not matter."""
    motions(guided_with(score, tumbles=True), left=0.1, by_warp_alone=0.5)
    found = choice()
    assert (found.kind, found.reason) == (kind, "PARTLY" if kind == "guided" else "TUMBLING")
    assert choice(guides=[{0: 7, 1: 7}]).kind == "guided"


def test_shapes_may_tumble_by_a_good_map_beside_a_poor_one(motions):
    """Someone who stands on their hands, beside a pair of which one is hardly like the other."""
    guided = guided_with(0.95, tumbles=True)
    guided.pairs[1, 2] = guided_with(0.5).pairs[0, 1]
    motions(guided, left=0.1)
    assert choice().kind == "guided"


def test_vertices_without_faces_are_no_bodies(motions):
    loose = TriangleMesh(np.concatenate([BARBELL.vertices, [[0.0, 0.0, 9.0]]]), BARBELL.faces)
    motions(guided_with(0.6, detour=1.8))
    assert choice(shapes=(BARBELL, loose)).kind == "guided"


@pytest.mark.parametrize(
    ("left", "by_warps", "kind"), [(0.2, 0.0, "guided"), (0.4, 0.2, "combined"), (0.4, 0.3, "guided")]
)
def test_a_warp_completes_what_leaves_much_that_it_removes(motions, left, by_warps, kind):
    motions(guided_with(0.6), left=left, by_warps=by_warps)
    found = choice(coherence=0.1)
    assert found.record() == {
        "kind": kind,
        "reason": "PARTLY" if kind == "guided" else "UNLIKE",
        "score": 0.6,
        "detour": 1.0,
        "left": left if kind == "guided" else by_warps,
    }


@pytest.mark.parametrize(
    ("left", "by_coarse", "by_warps", "found"),
    [
        (0.29, 0.0, 0.0, "guided"),
        (0.35, 0.29, 0.0, "faded"),
        (0.34, 0.29, 0.2, "guided"),
        (0.5, 0.3, 0.1, "faded"),
        (0.5, 0.4, 0.2, "combined"),
        (0.5, 0.4, 0.3, "faded"),
        (0.9, 0.4, 0.44, "faded"),
        (0.9, 0.6, 0.5, "faded"),
        (0.7, 0.6, 0.5, "guided"),
    ],
)
def test_a_coarse_warp_is_tried_before_a_fine_one(motions, left, by_coarse, by_warps, found):
    motions(guided_with(0.6), left=left, by_coarse=by_coarse, by_warps=by_warps, by_warp_alone=0.8)
    chosen = choice()
    if found == "faded":
        assert (chosen.kind, chosen.left, chosen.motion) == ("combined", by_coarse, FADED)
    else:
        assert (chosen.kind, chosen.motion is FADED) == (found, False)


@pytest.mark.parametrize(
    ("left", "by_warp_alone", "kind"),
    [(0.9, 0.6, "warp"), (0.9, 0.77, "combined"), (0.4, 0.33, "warp"), (0.4, 0.35, "combined"), (0.3, 0.1, "guided")],
)
def test_a_warp_replaces_what_leaves_much(motions, left, by_warp_alone, kind):
    motions(guided_with(0.6, turn=30.0), left=left, by_warps=0.1, by_warp_alone=by_warp_alone)
    found = choice()
    assert (found.kind, found.left) == (kind, {"guided": left, "combined": 0.1, "warp": by_warp_alone}[kind])
    assert found.turned == (0.0 if kind == "warp" else 30.0)
    assert choice(guides=[{0: 7, 1: 7}]).kind == ("guided" if kind == "guided" else "combined")


@pytest.mark.parametrize(
    ("score", "detour", "by_warp_alone", "kind"),
    [(0.3, 1.0, 0.21, "warp"), (0.3, 1.8, 0.21, "warp"), (0.3, 1.0, 0.22, "guided"), (0.5, 1.0, 0.1, "guided")],
)
def test_a_doubtful_map_is_given_up_for_a_warp_that_leaves_clearly_less(motions, score, detour, by_warp_alone, kind):
    motions(guided_with(score, detour=detour, crumpling=1.6), left=0.25, by_warp_alone=by_warp_alone)
    found = choice()
    assert (found.kind, found.reason) == (kind, "UNLIKE" if kind == "warp" else "PARTLY")
    assert found.left == (by_warp_alone if kind == "warp" else 0.25)
    assert choice(guides=[{0: 7, 1: 7}]).kind == "guided"


@pytest.mark.parametrize("score", [0.1, 0.3])
@pytest.mark.parametrize(
    ("left", "crumpling", "kind"), [(0.3, 1.5, "guided"), (0.3, 1.6, "warp"), (0.31, 1.5, "warp"), (0.1, 1.8, "warp")]
)
def test_an_unsure_map_is_kept_if_it_leaves_little_and_crumples_nothing(motions, score, left, crumpling, kind):
    motions(guided_with(score, detour=1.8, crumpling=crumpling), left=left, by_warp_alone=0.05)
    found = choice()
    assert (found.kind, found.left) == (kind, left if kind == "guided" else 0.05)


@pytest.mark.parametrize(
    ("score", "left", "by_coarse", "is_warped"),
    [(0.3, 0.25, 0.7, False), (0.3, 0.25, 0.6, True), (0.6, 0.5, 0.51, False), (0.6, 0.5, 0.5, True)],
)
def test_a_warp_is_not_computed_where_a_coarse_one_leaves_too_much(
    motions, monkeypatch, score, left, by_coarse, is_warped
):
    coarse, asked = SimpleNamespace(with_coherence=lambda coherence: ("coarse", coherence), sizes=np.ones(2)), []

    def warped(*arguments):
        asked.append(arguments[-1])
        return work_of(WARP if arguments[-1] == USUAL_EFFORT else coarse)()

    motions(guided_with(score, crumpling=1.6))
    monkeypatch.setattr(motion_candidates, "warp_motion", warped)
    shares = {("guided", 0.5): left, ("coarse", 0.5): by_coarse, ("warp", 0.5): 0.2}
    shares |= {(kind, 0.5): 1.0 for kind in ("combined", "faded")}
    monkeypatch.setattr(motion_candidates, "remaining_share", lambda motion, *_arguments: shares[motion])
    assert choice().kind == ("warp" if is_warped else "guided")
    assert (USUAL_EFFORT in asked) == is_warped


@pytest.mark.parametrize("sizes", [np.ones(2), np.array([0.5, 2.0])])
def test_a_warp_replaces_no_map_if_a_shape_grows_too_much(motions, sizes):
    growing = SimpleNamespace(with_coherence=WARP.with_coherence, sizes=sizes)
    motions(guided_with(0.6), warp=growing, by_warp_alone=0.1)
    assert choice().kind == ("warp" if sizes[0] == 1.0 else "combined")


def test_shapes_that_divide_or_merge_are_not_mapped_for_crumpling_nothing(motions):
    """A map without crumples may still tear bodies, and limbs that have no counterpart."""
    pair = (BARBELL, joined(BARBELL, BARBELL.moved((0.0, 0.0, 8.0))))
    motions(guided_with(0.3, detour=1.8), left=0.1, by_warp_alone=0.2)
    assert choice(shapes=pair).record()["reason"] == "APART"
    assert choice(shapes=(BARBELL, box())).record()["reason"] == "SOLID"


@pytest.mark.parametrize("score", [0.3, 0.6])
@pytest.mark.parametrize(
    ("crumpling", "by_warp", "left", "kind"),
    [(2.0, 1.59, 0.4, "warp"), (2.0, 1.61, 0.4, "guided"), (1.8, 1.0, 0.4, "guided"), (2.0, 1.0, 0.7, "guided")],
)
def test_a_warp_that_crumples_less_replaces_a_map_that_leaves_less(
    motions, monkeypatch, score, crumpling, by_warp, left, kind
):
    def arrived(motion, count, one, other):
        assert (motion, count) == (("warp", 0.5), 2)
        area = (by_warp if one == 0 else 1.0) * SHAPES[other].area
        return SimpleNamespace(mesh=SimpleNamespace(area=area))

    monkeypatch.setattr(motion_candidates, "arriving", arrived)
    motions(guided_with(score, detour=1.8, crumpling=crumpling), left=0.2, by_warp_alone=left)
    assert (choice().kind, choice().reason) == (kind, "CRUMPLED" if kind == "warp" else "PARTLY")
    assert choice(guides=[{0: 7, 1: 7}]).kind == "guided"
    motions(guided_with(score, crumpling=crumpling), left=0.35, by_coarse=0.1, by_warp_alone=left)
    assert choice().kind == (kind if kind == "warp" or score == 0.3 else "combined")


def test_no_warp_is_computed_twice(motions, monkeypatch):
    """A map that crumples shapes is compared with a coarse warp by its area, and then by what it leaves."""
    asked = []

    def warped(*arguments):
        asked.append(arguments[-1])
        return work_of(WARP)()

    motions(guided_with(0.6, crumpling=2.0), left=0.5, by_warp_alone=0.3)
    monkeypatch.setattr(motion_candidates, "warp_motion", warped)
    arrived = SimpleNamespace(mesh=SimpleNamespace(area=2.0 * SHAPES[0].area))
    monkeypatch.setattr(motion_candidates, "arriving", lambda *_arguments: arrived)
    assert (choice().kind, choice().reason) == ("warp", "UNLIKE")
    assert asked == 2 * [motion_candidates.COARSE_EFFORT, USUAL_EFFORT]


def test_a_poor_map_is_given_up_if_what_it_leaves_cannot_be_measured(motions, monkeypatch):
    motions(guided_with(0.1))
    monkeypatch.setattr(motion_candidates, "remaining_share", unless_guided)
    assert choice().record() == {"kind": "warp", "reason": "APART", "score": 0.1, "detour": 1.0, "left": 0.5}
