# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The choice of a motion by the score of the map of the surfaces."""

from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.sparse.linalg import ArpackNoConvergence

from convwass_addon.applications.motions import surface_choice
from convwass_addon.applications.motions.motion_choice import MotionChoice
from convwass_addon.applications.motions.surface_choice import motion_of_surfaces
from convwass_addon.errors import Cancelled, InputError, ResourceError
from tests.applications.motions.given_motions import BARBELL, WARP, chosen_by, give, guided_with
from tests.shapes import ball, box, renumbered, square


@pytest.fixture
def motions(monkeypatch):
    return partial(give, monkeypatch)


choice = partial(chosen_by, motion_of_surfaces)


@pytest.mark.parametrize(
    ("score", "kind", "reason"),
    [(0.95, "guided", "FITS"), (0.6, "combined", "UNLIKE"), (0.1, "transport", "APART")],
)
def test_automatic_follows_the_score_of_the_map(motions, score, kind, reason):
    motions(guided_with(score))
    found = choice()
    assert (found.kind, found.reason, found.score) == (kind, reason, score)
    assert (found.motion is None) == (kind == "transport")


def test_the_record_says_by_how_much_shapes_were_turned(motions):
    motions(guided_with(0.95, turn=-90.0))
    assert choice().record()["turned"] == 90


@pytest.mark.parametrize(("kind", "score"), [("guided", 0.6), ("automatic", 0.95), ("automatic", 0.6)])
def test_the_record_says_how_many_guides_were_left_out(motions, kind, score):
    motions(guided_with(score, left_out=2))
    assert choice(kind, guides=[{0: 7, 1: 7}]).record()["guides_left_out"] == 2
    motions(guided_with(score))
    assert "guides_left_out" not in choice(kind, guides=[{0: 7, 1: 7}]).record()


def test_automatic_does_without_what_fails(motions):
    motions(guided_with(0.6), combined=ResourceError("no memory"))
    found = choice().record()
    assert (found["kind"], found["reason"], found["failure"]) == ("guided", "PARTLY", "no memory")
    motions(InputError("no map"))
    assert choice().record() == {"kind": "transport", "reason": "FAILED", "failure": "no map"}


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


@pytest.mark.parametrize(("sizes", "kind"), [((1.0, 2.9), "warp"), ((3.1, 1.0), "transport")])
def test_shapes_that_grow_too_much_are_not_warped(motions, sizes, kind):
    warp = SimpleNamespace(with_coherence=WARP.with_coherence, sizes=np.array(sizes))
    motions(AssertionError("must not be asked for"), warp=warp, by_warp_alone=0.1)
    assert choice(shapes=(ball(points=200), box())).kind == kind


def test_shapes_without_limbs_are_warped(motions):
    motions(AssertionError("must not be asked for"), by_warp_alone=0.1)
    assert choice(shapes=(ball(points=200), box())).record() == {"kind": "warp", "reason": "SOLID", "left": 0.1}
    motions(guided_with(0.95))
    assert choice(shapes=(ball(points=200), square())).kind == "guided"
    assert choice("guided", shapes=(ball(points=200), box())).kind == "guided"


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


@pytest.mark.parametrize(
    ("score", "guides", "reason"),
    [(0.6, (), "OUTLINES"), (0.6, [{0: 7, 1: 7}], "UNLIKE"), (0.86, (), "PARTLY"), (0.95, (), "FITS")],
)
def test_solids_of_revolution_move_as_such_if_their_handles_do_not_map(motions, monkeypatch, score, guides, reason):
    """Unless there are guides, which that motion would not follow. It gets the map, which handles may follow."""
    guided = guided_with(score)
    motions(guided, left=0.4 if reason == "UNLIKE" else 0.1)

    def by_sections(request, found, _control):
        assert found is guided
        return MotionChoice("guided", "OUTLINES")

    monkeypatch.setattr(surface_choice, "motion_with_parts", by_sections)
    assert choice(guides=guides).reason == reason


def test_shapes_without_limbs_have_no_handles(motions, monkeypatch):
    def unwanted(*_arguments):
        raise AssertionError("must not be asked for")

    monkeypatch.setattr(surface_choice, "motion_with_parts", unwanted)
    for shapes in ((box(), renumbered(box())), (BARBELL, box())):
        motions(guided_with(0.6), by_warp_alone=0.1)
        assert choice(shapes=shapes).kind == "warp"
