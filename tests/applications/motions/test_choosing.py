# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The choice of a motion by the score of the map; the motions themselves have their own tests."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.sparse.linalg import ArpackNoConvergence

from convwass_addon.applications.motions import choosing
from convwass_addon.applications.motions.choosing import chosen_motion
from convwass_addon.applications.motions.guided_motion import GuidedPair
from convwass_addon.applications.motions.motion_choice import MotionChoice
from convwass_addon.applications.motions.motion_request import MotionRequest
from convwass_addon.errors import Cancelled, InputError, ResourceError
from convwass_addon.geometry.mesh import TriangleMesh
from convwass_addon.progress import UNINTERRUPTED, drained
from tests.applications.maps import coarse_maps
from tests.shapes import ball, box, joined, square

BARBELL = joined(ball(points=40), ball(center=(4.0, 1.0, 0.0), points=40))
BOXES = joined(box(), box((0.2, 1.0, 1.0), (2.0, 0.0, 1.0)), box((0.2, 0.2, 2.0), (0.0, 2.0, 0.0)))
OVERLAPPING = joined(box(), box((0.3, 0.3, 2.0), (0.3, 0.3, 1.0)), box((0.3, 2.0, 0.3), (-0.3, 1.0, -0.3)))
SHAPES = (BARBELL, BARBELL.moved((0.0, 0.0, 1.0)))
COMBINED = SimpleNamespace(with_coherence=lambda coherence: ("combined", coherence))
FADED = SimpleNamespace(with_coherence=lambda coherence: ("faded", coherence))
WARP = SimpleNamespace(with_coherence=lambda coherence: ("warp", coherence), sizes=np.ones(2))


def guided_with(score, turn=0.0, detour=1.0, left_out=0, crumpling=1.0):
    pair = GuidedPair(score, left_out, detour, turn, crumpling)
    return SimpleNamespace(pairs={(0, 1): pair}, with_coherence=lambda coherence: ("guided", coherence))


def work_of(outcome):
    """Return a generator function that yields nothing and returns the outcome, or raises it."""

    def work(*_arguments, **_options):
        if isinstance(outcome, Exception):
            raise outcome
        return outcome
        yield

    return work


def unless_guided(motion, *_arguments):
    """Return that half of the distance is left, or fail to measure it for a guided motion."""
    if motion == ("guided", 0.5):
        raise ResourceError("no memory")
    return 0.5


@pytest.fixture
def motions(monkeypatch):
    # The balls of a barbell lie apart.
    monkeypatch.setattr(choosing.SeparateBodies, "of", lambda request: None)

    def given(
        guided, warp=WARP, combined=COMBINED, left=0.4, by_coarse=1.0, by_warps=0.1, by_warp_alone=0.7, may_map=True
    ):
        outcomes = {"guided_motion": guided, "warp_motion": warp, "may_map": may_map}
        for name, outcome in outcomes.items():
            monkeypatch.setattr(choosing, name, work_of(outcome))

        def completed(*arguments):
            is_coarse = arguments[5].cells < 32 and arguments[6] == 0.0
            return work_of(FADED if is_coarse and combined is COMBINED else combined)()

        monkeypatch.setattr(choosing, "combined_motion", completed)
        shares = {("guided", 0.5): left, ("combined", 0.5): by_warps, ("warp", 0.5): by_warp_alone}
        shares["faded", 0.5] = by_coarse
        monkeypatch.setattr(choosing, "remaining_share", lambda motion, *_arguments: shares[motion])

    return given


def choice(kind="automatic", coherence=0.5, guides=(), shapes=SHAPES):
    request = MotionRequest(shapes, ("A", "B"), [(0, 1)], kind, coherence, guides)
    return drained(chosen_motion(request, UNINTERRUPTED))


@pytest.mark.parametrize(
    ("score", "kind", "reason"),
    [(0.95, "guided", "FITS"), (0.6, "combined", "UNLIKE"), (0.1, "transport", "APART")],
)
def test_automatic_follows_the_score_of_the_map(motions, score, kind, reason):
    motions(guided_with(score))
    found = choice()
    assert (found.kind, found.reason, found.score) == (kind, reason, score)
    assert (found.motion is None) == (kind == "transport")


def test_motions_are_computed_with_one_thread_of_blas(monkeypatch):
    # Threads of BLAS that wait for each other multiply the time of a warp, and decide on the last digits.
    threadpoolctl = pytest.importorskip("threadpoolctl")
    found = []

    def warped(*_arguments, **_options):
        libraries = threadpoolctl.threadpool_info()
        found.extend(library["num_threads"] for library in libraries if library["user_api"] == "blas")
        return WARP
        yield

    monkeypatch.setattr(choosing, "warp_motion", warped)
    with threadpoolctl.threadpool_limits(2, user_api="blas"):
        drained(chosen_motion(MotionRequest(SHAPES, ("a", "b"), [(0, 1)], "warp", 0.5), UNINTERRUPTED))
    assert set(found) == {1}


def test_the_record_says_by_how_much_shapes_were_turned(motions):
    motions(guided_with(0.95, turn=-90.0))
    assert choice().record()["turned"] == 90


@pytest.mark.parametrize(("kind", "score"), [("guided", 0.6), ("automatic", 0.95), ("automatic", 0.6)])
def test_the_record_says_how_many_guides_were_left_out(motions, kind, score):
    motions(guided_with(score, left_out=2))
    assert choice(kind, guides=[{0: 7, 1: 7}]).record()["guides_left_out"] == 2
    motions(guided_with(score))
    assert "guides_left_out" not in choice(kind, guides=[{0: 7, 1: 7}]).record()


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
    monkeypatch.setattr(choosing, "remaining_share", unless_guided)
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
        (0.9, 0.6, 0.5, "warp"),
    ],
)
def test_a_coarse_warp_is_tried_before_a_fine_one(motions, left, by_coarse, by_warps, found):
    motions(guided_with(0.6), left=left, by_coarse=by_coarse, by_warps=by_warps, by_warp_alone=0.5)
    chosen = choice()
    if found == "faded":
        assert (chosen.kind, chosen.left, chosen.motion) == ("combined", by_coarse, FADED)
    else:
        assert (chosen.kind, chosen.motion is FADED) == (found, False)


@pytest.mark.parametrize(
    ("left", "by_warps", "by_warp_alone", "kind"),
    [(0.9, 0.4, 0.2, "combined"), (0.9, 0.5, 0.6, "warp"), (0.7, 0.5, 0.7, "guided"), (0.5, 0.3, 0.2, "guided")],
)
def test_a_warp_replaces_what_leaves_most(motions, left, by_warps, by_warp_alone, kind):
    motions(guided_with(0.6, turn=30.0), left=left, by_warps=by_warps, by_warp_alone=by_warp_alone)
    found = choice()
    assert (found.kind, found.left) == (kind, {"guided": left, "combined": by_warps, "warp": by_warp_alone}[kind])
    assert found.turned == (0.0 if kind == "warp" else 30.0)


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


@pytest.mark.parametrize(("sizes", "kind"), [((1.0, 2.9), "warp"), ((3.1, 1.0), "transport")])
def test_shapes_that_grow_too_much_are_not_warped(motions, sizes, kind):
    warp = SimpleNamespace(with_coherence=WARP.with_coherence, sizes=np.array(sizes))
    motions(AssertionError("must not be asked for"), warp=warp, by_warp_alone=0.1)
    assert choice(shapes=(ball(points=200), box())).kind == kind


def test_automatic_does_without_what_fails(motions):
    motions(guided_with(0.6), combined=ResourceError("no memory"))
    found = choice().record()
    assert (found["kind"], found["reason"], found["failure"]) == ("guided", "PARTLY", "no memory")
    motions(InputError("no map"))
    assert choice().record() == {"kind": "transport", "reason": "FAILED", "failure": "no map"}


def test_a_requested_motion_is_computed_or_refused(motions):
    motions(guided_with(0.1))
    assert [choice(kind).kind for kind in ("guided", "warp", "transport")] == ["guided", "warp", "transport"]
    motions(InputError("no map"))
    with pytest.raises(InputError, match="no map"):
        choice("guided")


def test_guides_are_never_dropped_silently(motions):
    motions(InputError("no vertex 7"))
    with pytest.raises(InputError, match="no vertex 7"):
        choice(guides=[{0: 7, 1: 7}])


@pytest.mark.parametrize(("left", "kind"), [(0.6, "warp"), (0.7, "transport")])
def test_shapes_without_a_good_map_are_warped_if_that_joins_them(motions, left, kind):
    motions(guided_with(0.1), by_warp_alone=left)
    found = choice()
    assert found.record() == {"kind": kind, "reason": "APART", "score": 0.1, "detour": 1.0, "left": left}
    assert found.motion is (WARP if kind == "warp" else None)


@pytest.mark.parametrize("score", [0.1, 0.3])
@pytest.mark.parametrize(
    ("left", "crumpling", "kind"), [(0.3, 1.5, "guided"), (0.3, 1.6, "warp"), (0.31, 1.5, "warp"), (0.1, 1.8, "warp")]
)
def test_an_unsure_map_is_kept_if_it_leaves_little_and_crumples_nothing(motions, score, left, crumpling, kind):
    motions(guided_with(score, detour=1.8, crumpling=crumpling), left=left, by_warp_alone=0.05)
    found = choice()
    assert (found.kind, found.left) == (kind, left if kind == "guided" else 0.05)


@pytest.mark.parametrize(("by_coarse", "is_warped"), [(0.7, False), (0.6, True)])
def test_a_warp_is_not_computed_where_a_coarse_one_leaves_too_much(motions, monkeypatch, by_coarse, is_warped):
    coarse, asked = SimpleNamespace(with_coherence=lambda coherence: ("coarse", coherence), sizes=np.ones(2)), []

    def warped(*_arguments, effort=None):
        asked.append(effort)
        return work_of(WARP if effort is None else coarse)()

    motions(guided_with(0.3, detour=1.8, crumpling=1.6))
    monkeypatch.setattr(choosing, "warp_motion", warped)
    shares = {("guided", 0.5): 0.25, ("coarse", 0.5): by_coarse, ("warp", 0.5): 0.2}
    monkeypatch.setattr(choosing, "remaining_share", lambda motion, *_arguments: shares[motion])
    assert choice().kind == ("warp" if is_warped else "guided")
    assert (None in asked) == is_warped


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

    monkeypatch.setattr(choosing, "arriving", arrived)
    motions(guided_with(score, detour=1.8, crumpling=crumpling), left=0.2, by_warp_alone=left)
    assert (choice().kind, choice().reason) == (kind, "CRUMPLED" if kind == "warp" else "PARTLY")
    assert choice(guides=[{0: 7, 1: 7}]).kind == "guided"
    motions(guided_with(score, crumpling=crumpling), left=0.35, by_coarse=0.1, by_warp_alone=left)
    assert choice().kind == (kind if kind == "warp" or score == 0.3 else "combined")


def test_a_poor_map_is_given_up_if_what_it_leaves_cannot_be_measured(motions, monkeypatch):
    motions(guided_with(0.1))
    monkeypatch.setattr(choosing, "remaining_share", unless_guided)
    assert choice().record() == {"kind": "warp", "reason": "APART", "score": 0.1, "detour": 1.0, "left": 0.5}


def test_shapes_without_limbs_are_warped(motions):
    motions(AssertionError("must not be asked for"), by_warp_alone=0.1)
    assert choice(shapes=(ball(points=200), box())).record() == {"kind": "warp", "reason": "SOLID", "left": 0.1}
    motions(guided_with(0.95))
    assert choice(shapes=(ball(points=200), square())).kind == "guided"
    assert choice("guided", shapes=(ball(points=200), box())).kind == "guided"


def test_equal_shapes_without_limbs_need_no_map():
    round_ = ball(points=200)
    egg = TriangleMesh(round_.vertices * (1.0, 2.0, 3.0), round_.faces)
    with coarse_maps():
        found = choice(shapes=(egg, egg.moved((3.0, 1.0, 0.0)))).record()
    assert found == {"kind": "warp", "reason": "SOLID", "left": 0.0}


def test_limbs_merge_with_a_shape_that_has_none(motions):
    """Unless they map onto it: a bent rod is not convex, and a straight one is."""
    pair, solid = (BARBELL, box()), {"reason": "SOLID", "score": 0.6, "detour": 1.0}
    motions(guided_with(0.6), by_warp_alone=0.1)
    assert choice(shapes=pair).record() == {"kind": "warp", **solid, "left": 0.1}
    assert choice(shapes=pair, guides=[{0: 7, 1: 7}]).kind == "combined"
    motions(guided_with(0.6), warp=ResourceError("no memory"))
    assert choice(shapes=pair).record() == {"kind": "transport", **solid, "reason": "FAILED", "failure": "no memory"}
    motions(guided_with(0.95))
    assert choice(shapes=pair).kind == "guided"
    # A map that is good between two shapes with limbs is not good enough here.
    motions(guided_with(0.9), by_warp_alone=0.1)
    assert choice(shapes=pair).kind == "warp"
    assert choice().kind == "guided"


@pytest.mark.parametrize(
    ("limbed", "crumpling", "bends"),
    [(BOXES, 1.3, True), (OVERLAPPING, 1.3, True), (BOXES, 1.2, False), (BARBELL, 1.3, False)],
    ids=["bent", "overlapping", "little", "round"],
)
def test_plane_faces_are_transported_rather_than_bent(motions, monkeypatch, limbed, crumpling, bends):
    motions(guided_with(0.6), by_warp_alone=0.1)
    monkeypatch.setattr(choosing, "_warp_crumpling", lambda *_arguments: crumpling)
    found = choice(shapes=(limbed, box((1.0, 2.0, 3.0))))
    assert (found.kind, found.reason) == (("transport", "BENT") if bends else ("warp", "SOLID"))
    assert found.left == (None if bends else 0.1)
    assert choice("warp", shapes=(limbed, box())).motion is WARP


def test_a_warp_that_would_replace_a_map_is_not_used_if_it_bends(motions, monkeypatch):
    motions(guided_with(0.6, crumpling=1.9), left=0.6, by_warp_alone=0.1)
    shapes = (BOXES, BOXES.moved((0.0, 1.0, 0.0)))
    monkeypatch.setattr(choosing, "_warp_crumpling", lambda *_arguments: 1.2)
    assert choice(shapes=shapes).kind == "warp"
    monkeypatch.setattr(choosing, "_warp_crumpling", lambda *_arguments: 1.4)
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
    shapes = tuple(joined(box((1.0, 2.0, 0.3)), ball(0.6, (0.0, shift, 0.3), points=60)) for shift in (0.0, 0.5))

    def by_surfaces(request, _control):
        kind, left = ("apart", apart) if request.shapes is shapes else ("outside", outside)
        return MotionChoice("guided", "PARTLY", kind, left=left)
        yield

    monkeypatch.setattr(choosing, "_by_surfaces", by_surfaces)
    monkeypatch.setattr(choosing, "following", lambda motion, *_shapes: motion)
    assert choice(shapes=shapes).motion == used


def test_without_an_outer_surface_bodies_are_mapped_as_they_are(motions, monkeypatch):
    def failing(*_arguments):
        raise ValueError("not a number")

    motions(guided_with(0.95))
    monkeypatch.setattr(choosing, "with_skins", failing)
    assert choice().score == 0.95


def test_limbs_are_not_mapped_to_a_shape_that_has_none_if_a_rough_map_is_hopeless(motions):
    """The rough map matters only there, and not with guides."""
    motions(AssertionError("must not be asked for"), by_warp_alone=0.1, may_map=False)
    assert choice(shapes=(BARBELL, box())).record() == {"kind": "warp", "reason": "SOLID", "left": 0.1}
    motions(guided_with(0.95), may_map=False)
    assert choice(shapes=(BARBELL, box()), guides=[{0: 7, 1: 7}]).kind == "guided"
    assert choice().kind == "guided"
    for failure in (InputError("too coarse"), np.linalg.LinAlgError("singular"), ArpackNoConvergence("no", [], [])):
        motions(guided_with(0.95), may_map=failure)
        assert choice(shapes=(BARBELL, box())).kind == "guided"
    motions(guided_with(0.95), may_map=Cancelled("Cancelled."))
    with pytest.raises(Cancelled):
        choice(shapes=(BARBELL, box()))


def test_without_coherence_there_is_no_motion(motions):
    motions(AssertionError("must not be asked for"))
    assert choice(coherence=0.0).kind == "transport"
