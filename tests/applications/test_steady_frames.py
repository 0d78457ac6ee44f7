# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames of flat morphs without holes that come or go for a few frames, on rings that grow evenly."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from convwass_addon.applications.flat import flat_morph as flat_morph_module
from convwass_addon.applications.flat.flat_morph import flat_morph
from convwass_addon.applications.flat.flat_problem import flat_problem, pieces_of
from convwass_addon.applications.flat.flat_settings import FlatSettings
from convwass_addon.applications.flat.flat_shapes import FlatShape
from convwass_addon.applications.flat.steady_frames import steady_frames
from convwass_addon.applications.morphs.layouts import path_blends, single_blend
from convwass_addon.applications.morphs.moved_room import Room
from convwass_addon.errors import Cancelled
from convwass_addon.geometry.plane.outlines import FlatRegion, Outline
from tests.controls import CountingControl
from tests.flat_shapes import ellipse, rectangle

SETTINGS = FlatSettings(resolution=128, motion="transport")
CENTERS = np.array([[0.0, 0.0], [3.0, 1.0]])
COUNT = 8


def ring(center, radius):
    return FlatShape((ellipse(center, (radius, radius)), ellipse(center, (radius / 2, radius / 2))[::-1]))


SHAPES, NAMES = [ring(CENTERS[0], 1.0), ring(CENTERS[1], 2.0)], ["small", "large"]


@pytest.fixture(scope="module")
def problem():
    return flat_problem(SHAPES, pieces_of(SHAPES, NAMES, SETTINGS), NAMES, SETTINGS)


@pytest.fixture(scope="module")
def frames():
    work = flat_morph(SHAPES, NAMES, path_blends(2, COUNT), SETTINGS)
    return [step.payload for step in work if step.payload is not None]


def filled(frame):
    """Return a frame as a disk of the same area."""
    center = np.asarray(frame.blend.weights) @ CENTERS
    radius = np.sqrt(frame.outline.area / np.pi)
    disk = Outline((FlatRegion(ellipse(center, (radius, radius))),))
    return replace(frame, outline=disk, record={**frame.record, "found": {"regions": 1, "holes": 0}})


def with_disks(frames, *numbers):
    return [filled(frame) if number in numbers else frame for number, frame in enumerate(frames)]


def holes(frames):
    return [frame.record["found"]["holes"] for frame in frames if frame.blend.source is None]


@pytest.mark.parametrize("numbers", [[3], [3, 4], [1, 2, 3], [5, 6, 7], [2, 4, 5]])
def test_short_runs_become_means_of_the_frames_around_them(problem, frames, numbers):
    given = with_disks(frames, *numbers)
    found = list(steady_frames(given, problem))
    assert [frame.blend for frame in found] == [frame.blend for frame in frames]
    assert holes(found) == [1] * (COUNT - 1)
    for number in numbers:
        frame, t = found[number], number / COUNT
        assert frame.record["mean_of_neighbors"]
        assert frame.outline.area == pytest.approx(given[number].outline.area, rel=1e-3)
        center = np.array(frame.blend.weights) @ CENTERS
        outer, inner = frame.outline.rings
        # Of the mean of concentric circles, the radii are the means.
        for points, radius in ((outer, 1.0 + t), (inner, 0.5 + 0.5 * t)):
            assert np.linalg.norm(points - center, axis=1) == pytest.approx(radius, abs=0.5 * problem.lattice.spacing)


@pytest.mark.parametrize("numbers", [[2, 3, 4, 5], [1, 2, 3, 4, 5, 6, 7]])
def test_long_runs_remain(problem, frames, numbers):
    given = with_disks(frames, *numbers)
    assert list(steady_frames(given, problem)) == given


def test_a_single_change_remains(problem, frames):
    # A disk becomes a ring at the fifth frame.
    shapes = [FlatShape((ellipse(CENTERS[0]),)), SHAPES[1]]
    disk = flat_problem(shapes, pieces_of(shapes, NAMES, SETTINGS), NAMES, SETTINGS)
    given = with_disks(frames, 1, 2, 3, 4)
    assert list(steady_frames(given, disk)) == given


def test_frames_are_kept_if_their_mean_has_another_topology(problem, frames):
    # The holes of the two rings do not overlap, so their mean has none.
    def aside(frame, shift):
        return replace(frame, outline=frame.outline.moved(shift))

    given = with_disks(frames, 3)
    given[2], given[4] = aside(given[2], np.array([-1.5, 0.0])), aside(given[4], np.array([1.5, 0.0]))
    assert list(steady_frames(given, problem)) == given


def test_inputs_have_the_outline_that_they_were_drawn_with(problem, frames):
    """The grid of moved shapes is larger than the one on which the inputs were drawn."""
    room = Room(problem.lattice.origin - 1.0, problem.lattice.origin + np.array(problem.lattice.shape) * 0.1)
    larger = problem.on(problem.lattice.holding(room), ())
    assert larger.lattice.shape != problem.lattice.shape
    given = with_disks(frames, 1, 2)
    found = list(steady_frames(given, larger))
    assert holes(found) == [1] * (COUNT - 1)
    assert np.linalg.norm(found[1].outline.rings[0] - found[1].blend.weights @ CENTERS, axis=1) == pytest.approx(
        1.0 + 1 / COUNT, abs=0.5 * problem.lattice.spacing
    )


def test_frames_are_not_replaced_by_means_across_an_input():
    """A ring becomes a disk, and this a ring again: the frames next to the disk are disks as well."""
    shapes = [SHAPES[0], FlatShape((ellipse(CENTERS[1]),)), ring(CENTERS[0], 2.0)]
    names = ["first", "disk", "last"]
    three = flat_problem(shapes, pieces_of(shapes, names, SETTINGS), names, SETTINGS)
    work = flat_morph(shapes, names, path_blends(3, 4), SETTINGS)
    made = [step.payload for step in work if step.payload is not None]
    given = [relabeled(frame, int(number not in (3, 5))) for number, frame in enumerate(made)]
    assert list(steady_frames(given, three)) == given


def relabeled(frame, holes):
    return (
        frame
        if frame.outline is None
        else replace(frame, record={**frame.record, "found": {"regions": 1, "holes": holes}})
    )


def test_frames_without_a_mean_are_kept(problem, frames):
    """Bars far from each other have nothing in common."""
    given = with_disks(frames, 3)
    for number, aside in ((2, -1.8), (4, 1.7)):
        low = number / COUNT * CENTERS[1] + np.array([aside, 0.0])
        bar = Outline((FlatRegion(rectangle(low, low + np.array([0.1, 1.0]))),))
        given[number] = replace(given[number], outline=bar)
    assert list(steady_frames(given, problem)) == given


def test_work_can_be_cancelled_between_frames(problem, frames):
    control = CountingControl(3)
    with pytest.raises(Cancelled):
        list(steady_frames(frames, problem, control))


@pytest.mark.parametrize(
    ("settings", "blends", "wanted", "steadied"),
    [
        ({}, path_blends(2, 4), None, True),
        ({"motion": "transport"}, path_blends(2, 4), None, False),
        ({"mend": False}, path_blends(2, 4), None, False),
        ({"level": "half-max"}, path_blends(2, 4), None, False),
        ({"output": "densities"}, path_blends(2, 4), None, False),
        ({}, path_blends(2, 4), range(1, 3), False),
        ({}, single_blend([1, 1], 2), None, False),
    ],
)
def test_which_morphs_are_steadied(monkeypatch, settings, blends, wanted, steadied):
    asked = []

    def watched(frames, *others):
        asked.append(others)
        return steady_frames(frames, *others)

    monkeypatch.setattr(flat_morph_module, "steady_frames", watched)
    found = list(flat_morph(SHAPES, NAMES, blends, FlatSettings(**{"resolution": 96, **settings}), wanted=wanted))
    assert found[-1].fraction == 1.0
    assert bool(asked) == steadied


def test_frames_are_at_most_three_late(problem, frames):
    taken = []

    def counted():
        for frame in with_disks(frames, 2, 3, 4, 5):
            taken.append(frame)
            yield frame

    for done, _ in enumerate(steady_frames(counted(), problem), start=1):
        assert len(taken) <= done + 3
