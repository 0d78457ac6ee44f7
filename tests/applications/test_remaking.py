# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blends that are limited by their neighbors, on balls that move along a line: limits move their centers."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from convwass_addon.applications.morphs.frame_file import as_stored
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph_problem import MorphFrame
from convwass_addon.applications.morphs.remaking import BakeReview, Remaking
from convwass_addon.progress import UNINTERRUPTED, drained
from tests.shapes import ball

BLENDS = path_blends(2, 24)
ONE_PIECE = {"pieces": 1, "handles": 0, "bubbles": 0}


def frame(blend, place, held=None):
    record = {"found": ONE_PIECE, "most": ONE_PIECE} | (
        {} if held is None else {"held": held, "held_share": 1e-3 * held}
    )
    return MorphFrame(blend, None if blend.source is not None else ball(1.0, (place, 0.0, 0.0)), record)


class Balls(Remaking):
    """Computes a blend again by moving its ball within reach of the demand's surface."""

    def __init__(self, places, motion="guided"):
        super().__init__(SimpleNamespace(settings=SimpleNamespace(motion=motion)), [], None, None, UNINTERRUPTED)
        self.places, self.asked = dict(zip(BLENDS, places, strict=True)), []

    def _made(self, asked):
        yield from ()
        self.asked.append([blend.frame for blend in asked])
        found = {}
        for blend, demand in asked.items():
            place = self.places[blend]
            if demand.near is not None:
                center = demand.near.vertices.mean(axis=0)[0]
                place = np.clip(place, center - demand.reach, center + demand.reach)
            found[blend] = frame(blend, place, 10 if place != self.places[blend] else 0)
        return found


def evened(places, motion="guided"):
    """The places after blends have been limited, and the progress."""
    review, balls = BakeReview(BLENDS, {}), Balls(places, motion)
    for blend, place in zip(BLENDS, places, strict=True):
        review.add(frame(blend, place))
    reports = list(balls.fitted(review))
    found = dict(balls.places)
    for report in reports:
        if report.payload is not None:
            found[report.payload.blend] = report.payload.mesh.vertices.mean(axis=0)[0]
    return np.array(list(found.values())), reports, balls


def even(**extra):
    """Places of even steps of 0.2, of which some are longer."""
    return np.cumsum([0.0, *(0.2 + extra.get(f"at_{i}", 0.0) for i in range(1, 25))])


def test_a_jump_is_spread_over_the_blends_behind_it():
    places = even(at_9=0.3)
    after, reports, _ = evened(places)
    # Steps are limited to 1.5 times the usual one, as measured, so three blends make up for it.
    np.testing.assert_allclose(np.diff(after)[8:11], 0.3, atol=0.02)
    assert np.diff(after).max() < 0.31
    np.testing.assert_array_equal(after[:9], places[:9])
    np.testing.assert_array_equal(after[12:], places[12:])
    fractions = [report.fraction for report in reports]
    assert fractions == sorted(fractions)


def test_even_blends_stay():
    after, reports, balls = evened(even())
    np.testing.assert_array_equal(after, even())
    assert not reports and not balls.asked


def test_a_chain_goes_on_through_blends_that_a_later_one_starts_from():
    """Otherwise the second jump would be limited from where the first one has not been yet."""
    places = even(at_9=0.3, at_11=0.3)
    after, _, _ = evened(places)
    assert np.diff(after).max() == pytest.approx(0.3, abs=0.02)
    np.testing.assert_array_equal(after[16:], places[16:])


def test_jumps_at_both_ends_are_limited_side_by_side():
    after, _, balls = evened(even(at_3=0.3, at_20=0.3))
    assert np.diff(after).max() == pytest.approx(0.3, abs=0.02)
    assert {frozenset(asked) for asked in balls.asked} >= {frozenset((3, 19)), frozenset((4, 18))}


def test_a_jump_near_the_end_stays_where_it_is():
    """It would only move to the last blend."""
    places = even(at_23=2.0)
    after, _, _ = evened(places)
    np.testing.assert_array_equal(after, places)


def test_where_chains_meet_no_step_becomes_longer():
    """One blend is far ahead: limited from one side, it would be farther from the other one."""
    places = even()
    places[12] += 0.4
    after, _, _ = evened(places)
    assert np.abs(np.diff(after)).max() < np.abs(np.diff(places)).max()


def test_by_transport_only_small_parts_are_held_back():
    after, _, _ = evened(even(at_9=0.3), "transport")
    np.testing.assert_array_equal(after, even(at_9=0.3))


class Handles(Balls):
    """The ball of one blend has a handle unless it is close enough to a neighbor."""

    def __init__(self, places, flickering, close):
        super().__init__(places)
        self.flickering, self.close, self.tried = flickering, close, []

    def _made(self, asked):
        found = yield from super()._made(asked)
        for blend, demand in asked.items():
            if blend == self.flickering:
                self.tried.append(demand.reach)
                if demand.near is None or demand.reach > self.close:
                    found[blend] = with_handle(found[blend])
        return found


def with_handle(made):
    return replace(made, record={**made.record, "found": ONE_PIECE | {"handles": 1}})


def matched(places, close, at=12):
    """The frame that replaces a blend with a handle, if any, and the reaches that were tried."""
    review, handles = BakeReview(BLENDS, {}), Handles(places, BLENDS[at], close)
    for blend, place in zip(BLENDS, places, strict=True):
        own = frame(blend, place)
        review.add(with_handle(own) if blend == BLENDS[at] else own)
    payloads = [report.payload for report in handles.fitted(review) if report.payload is not None]
    return payloads, handles.tried


def test_a_handle_that_repairs_cannot_remove_is_removed_near_a_neighbor():
    (made,), tried = matched(even(), close=0.1)
    assert made.blend == BLENDS[12]
    assert made.record["found"] == ONE_PIECE
    # Once by repairs alone, once as it was, within a usual step of both neighbors, and within 0.35 of one.
    assert tried == pytest.approx([0.0, 0.0, 0.2, 0.2, 0.07], abs=0.01)
    assert matched(even(), close=0.3)[1] == pytest.approx([0.0, 0.0, 0.2], abs=0.01)


def test_a_handle_stays_where_its_removal_would_need_a_long_step():
    """Close to either neighbor, the ball would be far from the other one."""
    places = even(at_12=0.14, at_13=0.14)
    assert matched(places, close=0.1)[0] == []


def test_without_a_usual_step_a_handle_stays():
    blends = path_blends(2, 3)
    review, handles = BakeReview(blends, {}), Handles(even(), blends[1], 1.0)
    handles.places = dict(zip(blends, even()[:4], strict=True))
    for blend, place in handles.places.items():
        review.add(with_handle(frame(blend, place)) if blend == blends[1] else frame(blend, place))
    assert review.topology.asked()
    assert [report.payload for report in handles.fitted(review) if report.payload is not None] == []


class Flickering(Balls):
    """Two blends next to each other have a handle without a demand; repairs remove the one of the first."""

    def _made(self, asked):
        found = yield from super()._made(asked)
        return {
            blend: with_handle(made) if blend == BLENDS[13] and asked[blend].near is None else made
            for blend, made in found.items()
        }


def test_a_neighbor_that_was_repaired_is_not_computed_again():
    """Nor does it get back the handle that was removed before."""
    review, balls = BakeReview(BLENDS, {}), Flickering(even())
    for blend, place in zip(BLENDS, even(), strict=True):
        own = frame(blend, place)
        own = replace(own, record={**own.record, "most": ONE_PIECE | {"handles": 1}})
        review.add(with_handle(own) if blend in BLENDS[12:14] else own)
    asked, real, repaired = [], balls._made, []

    def made(demands):
        found = yield from real(demands)
        asked.append(demands)
        repaired.extend(frame for blend, frame in found.items() if blend == BLENDS[12])
        return found

    balls._made = made
    drained(balls.fitted(review))
    assert asked[0][BLENDS[12]].most.handles == 0
    assert len(repaired) == 1
    near = [demands[BLENDS[13]].near for demands in asked if BLENDS[13] in demands]
    own = as_stored(repaired[0].mesh).vertices
    assert any(mesh is not None and np.array_equal(mesh.vertices, own) for mesh in near)
