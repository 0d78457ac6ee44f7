# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Flat morphs against closed forms, and invalid input."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.flat.flat_colors import carried_colors
from convwass_addon.applications.flat.flat_morph import flat_morph
from convwass_addon.applications.flat.flat_settings import FlatSettings
from convwass_addon.applications.flat.flat_shapes import FlatImage, FlatShape
from convwass_addon.applications.flat.gray_images import regraded
from convwass_addon.applications.flat.letters import letters_of, matched_letters
from convwass_addon.applications.morphs.layouts import Blend, grid_blends, path_blends, single_blend
from convwass_addon.errors import Cancelled, InputError
from convwass_addon.geometry.plane.coverage import coverage
from convwass_addon.geometry.plane.planar_fill import filled_boundary
from tests.controls import CountingControl
from tests.flat_shapes import ellipse, rectangle

SETTINGS = FlatSettings(resolution=128, motion="transport")


def shape(*rings, **options):
    return FlatShape(tuple(rings), **options)


def frames_of(shapes, blends, settings=SETTINGS, **options):
    names = [f"shape {index}" for index in range(len(shapes))]
    return [step.payload for step in flat_morph(shapes, names, blends, settings, **options) if step.payload is not None]


def overlap(outline, ring):
    """Intersection over union of an outline and a polygon, on fine cells."""
    low = np.minimum(outline.points.min(axis=0), ring.min(axis=0)) - 0.05
    factor = 500 / float(np.max(np.maximum(outline.points.max(axis=0), ring.max(axis=0)) + 0.05 - low))
    one, other = (
        coverage(filled_boundary(rings, "non-zero").moved(-low * factor, factor), (500, 500))
        for rings in (outline.rings, [ring])
    )
    return np.minimum(one, other).sum() / np.maximum(one, other).sum()


@pytest.mark.parametrize(
    ("first", "second", "middle"),
    [
        (ellipse((0, 0)), ellipse((5, 2)), ellipse((2.5, 1))),
        (ellipse((0, 0)), ellipse((3, 0), (2, 2)), ellipse((1.5, 0), (1.5, 1.5))),
        # Of ellipses with the same axes the radii are interpolated.
        (ellipse(radii=(2, 1)), ellipse(radii=(1, 2)), ellipse(radii=(1.5, 1.5))),
        (rectangle((0, 0), (2, 1)), rectangle((0, 0), (1, 2)), rectangle((0, 0), (1.5, 1.5))),
        (rectangle((0, 0), (1, 1)), rectangle((4, 4), (6, 6)), rectangle((2, 2), (3.5, 3.5))),
    ],
)
@pytest.mark.parametrize("sharpness", [None, 1.0])
def test_halfway_between_shapes_whose_map_is_linear(first, second, middle, sharpness):
    settings = FlatSettings(resolution=128, motion="transport", sharpness=sharpness)
    (frame,) = frames_of([shape(first), shape(second)], single_blend([1, 1], 2), settings)
    assert frame.record["converged"]
    assert overlap(frame.outline, middle) > 0.97
    assert frame.outline.area == pytest.approx(frame.record["area_wanted"], rel=1e-3)


def test_evenly_filled_blends_are_read_without_noise():
    (frame,) = frames_of([shape(rectangle((0, 0), (3, 1))), shape(rectangle((0, 0), (1, 3)))], single_blend([1, 1], 2))
    assert (len(frame.outline.regions), frame.outline.holes) == (1, 0)
    assert frame.record["mended"] == {"crumbs": 0, "filled": 0, "bridged": 0}
    assert frame.outline.area == pytest.approx(4.0, rel=2e-2)


def test_the_area_of_shapes_in_one_proportion_is_exact():
    (frame,) = frames_of([shape(ellipse()), shape(ellipse(radii=(3, 3)))], single_blend([0.25, 0.75], 2))
    assert frame.outline.area == pytest.approx(np.pi * 2.5**2, rel=2e-3)


def test_turned_ellipses_meet_in_the_ellipse_of_the_closed_form():
    angle = np.pi / 4
    turned = [ellipse(radii=(2, 1), angle=sign * angle) for sign in (1, -1)]
    # Covariances A and B with the same eigenvalues; the barycenter's is ((I + T) / 2) A ((I + T) / 2).
    a, b = (np.array([[2.5, sign * 1.5], [sign * 1.5, 2.5]]) for sign in (1, -1))
    root = _root(a)
    linear = np.linalg.inv(root) @ _root(root @ b @ root) @ np.linalg.inv(root)
    half = 0.5 * (np.eye(2) + linear)
    expected = turned[0] @ half.T
    (frame,) = frames_of([shape(ring) for ring in turned], single_blend([1, 1], 2))
    assert overlap(frame.outline, expected) > 0.97
    # It is larger than both, as a level for the interpolated area would not show.
    assert frame.outline.area == pytest.approx(1.125 * 2 * np.pi, rel=2e-2)


def _root(matrix):
    values, vectors = np.linalg.eigh(matrix)
    return vectors @ np.diag(np.sqrt(values)) @ vectors.T


def test_inputs_are_unchanged_and_neighboring_blends_have_their_holes():
    ring = [ellipse((0, 0), (2, 2)), ellipse((0, 0), (1, 1))[::-1]]
    two = [ellipse((0, 0), (2, 2)), ellipse((-0.9, 0), (0.6, 0.6))[::-1], ellipse((0.9, 0), (0.6, 0.6))[::-1]]
    blends = [Blend((1.0, 0.0)), Blend((0.98, 0.02)), Blend((0.02, 0.98)), Blend((0.0, 1.0))]
    frames = frames_of([shape(*ring), shape(*two)], blends)
    assert [frame.outline is None for frame in frames] == [True, False, False, True]
    assert [(len(frame.outline.regions), frame.outline.holes) for frame in frames[1:3]] == [(1, 1), (1, 2)]
    assert frames[0].record["area"] == pytest.approx(3 * np.pi, rel=1e-5)


def test_fill_rules_determine_holes():
    rings = [ellipse((0, 0), (2, 2)), ellipse((0, 0), (1, 1))]
    for rule, area in (("non-zero", 4 * np.pi), ("even-odd", 3 * np.pi)):
        frame = frames_of([shape(*rings, rule=rule), shape(ellipse())], [Blend((1.0, 0.0))])[0]
        assert frame.record["area"] == pytest.approx(area, rel=1e-5)


def test_a_path_has_all_frames_in_order_and_the_same_with_more_threads():
    shapes = [shape(ellipse()), shape(rectangle((3, 0), (5, 1)))]
    one, two = (frames_of(shapes, path_blends(2, 6), workers=workers) for workers in (1, 2))
    assert [frame.blend.frame for frame in one] == list(range(7))
    for a, b in zip(one[1:-1], two[1:-1], strict=True):
        np.testing.assert_array_equal(a.outline.points, b.outline.points)


def test_a_sheet_of_four_shapes():
    shapes = [shape(ellipse((4 * i, 0), (1 + i / 4, 1))) for i in range(4)]
    frames = frames_of(shapes, grid_blends(4, 3))
    assert len(frames) == 9
    assert overlap(frames[4].outline, ellipse((6, 0), (1.375, 1))) > 0.97


def test_origins_lead_back_to_the_inputs():
    (frame,) = frames_of([shape(ellipse((0, 0))), shape(ellipse((6, 0), (2, 2)))], single_blend([1, 1], 2))
    inner = np.stack([np.cos(np.arange(12)), np.sin(np.arange(12))], axis=1)
    first, second = frame.origins.at(inner * 1.2 + [3, 0])
    np.testing.assert_allclose(first, inner * 0.8, atol=0.08)
    np.testing.assert_allclose(second, inner * 1.6 + [6, 0], atol=0.12)


def test_colors_are_mixed_by_where_matter_comes_from():
    red, blue, white = [1, 0, 0, 1], [0, 0, 1, 1], [1, 1, 1, 1]
    halves = (rectangle((0, 0), (1, 2)), rectangle((1, 0), (2, 2)))
    two = FlatShape(halves, colors=np.array([red, blue], dtype=float))
    plain = FlatShape((rectangle((10, 0), (12, 2)),), colors=np.array([white], dtype=float))
    (frame,) = frames_of([two, plain], single_blend([3, 1], 2))
    found = carried_colors(np.array([[3.0, 1.0], [4.0, 1.0]]), frame, [two, plain])
    np.testing.assert_allclose(found, [[1, 0.25, 0.25, 1], [0.25, 0.25, 1, 1]])
    assert carried_colors(np.zeros((1, 2)), frame, [shape(*halves), shape(*halves)]) is None


def test_words_go_letter_by_letter():
    def word(widths, left):
        starts = left + 1.5 * np.arange(len(widths))
        return shape(*(rectangle((x, 0), (x + w, 1)) for x, w in zip(starts, widths, strict=True)))

    shapes = [word([1, 1, 1], 0), word([0.5, 0.5, 0.5], 0)]
    settings = FlatSettings(resolution=128, motion="transport", words="letters")
    (frame,) = frames_of(shapes, single_blend([1, 1], 2), settings)
    assert len(frame.outline.regions) == 3
    assert list(frame.record["parts"]) == ["letter 1", "letter 2", "letter 3"]


def test_letters_are_read_in_lines_with_their_dots_and_holes():
    i = [rectangle((0, 2), (0.4, 3)), rectangle((0, 3.3), (0.4, 3.7))]
    o = [ellipse((1.2, 2.5), (0.5, 0.5)), ellipse((1.2, 2.5), (0.3, 0.3))[::-1]]
    below = [rectangle((0.1, 0), (1.1, 1.4))]
    order = [4, 2, 0, 3, 1]
    rings = [[*i, *o, *below][k] for k in order]
    found = letters_of(shape(*rings))
    assert [sorted(order[k] for k in letter) for letter in found] == [[0, 1], [2, 3], [4]]


def test_letters_can_be_given_and_neighbors_go_together_where_counts_differ():
    five = shape(*(rectangle((x, 0), (x + 0.5, 1)) for x in range(5)), letters=(4, 3, 2, 1, 0))
    two = shape(*(rectangle((x, 0), (x + 0.5, 1)) for x in range(2)))
    parts = matched_letters([five, two], ["five", "two"])
    assert [len(own) for own in parts] == [2, 2]
    assert sorted(np.concatenate(parts[0]).tolist()) == [0, 1, 2, 3, 4]
    assert 4 in parts[0][0]


def test_gray_images_become_densities_with_the_grays_of_the_inputs():
    def spot(x):
        return np.exp(-((np.arange(64)[:, None] - x) ** 2 + (np.arange(64) - 32.0) ** 2) / 50.0)

    images = [FlatImage(spot(x), 1 / 64) for x in (16.0, 48.0)]
    settings = FlatSettings(resolution=128, motion="transport", output="densities")
    first, middle, last = frames_of(images, [Blend((1.0, 0.0)), Blend((0.5, 0.5)), Blend((0.0, 1.0))], settings)
    mass = [frame.density.values.sum() * frame.density.pixel**2 for frame in (first, middle, last)]
    assert mass[1] == pytest.approx(0.5 * (mass[0] + mass[2]), rel=1e-4)
    graded = regraded(middle, [first.density, last.density])
    assert graded.values.max() == pytest.approx(0.5 * (first.density.values.max() + last.density.values.max()))
    peak = np.unravel_index(np.argmax(graded.values), graded.values.shape)
    place = np.array(middle.density.corner) + (np.array(peak) + 0.5) * middle.density.pixel
    np.testing.assert_allclose(place, [32.5 / 64, 32.5 / 64], atol=0.02)


def test_silhouettes_and_curves_can_be_mixed():
    values = np.zeros((80, 80))
    values[20:60, 20:60] = 0.9
    values[5:10, 5:10] = 0.3
    image = FlatImage(values, 0.05, (0.0, 0.0), "silhouette")
    (frame,) = frames_of([image, shape(rectangle((10, 0), (12, 2)))], single_blend([1, 1], 2))
    assert overlap(frame.outline, rectangle((5.5, 0.5), (7.5, 2.5))) > 0.97


@pytest.mark.parametrize(
    ("bad", "message"),
    [
        (FlatShape(()), "no closed curve"),
        (shape(np.array([[0, 0], [1, 1], [2, 2.0]])), "fills no area"),
        (shape(rectangle(), rectangle()[::-1]), "fills no area"),
        (shape(np.zeros((4, 2))), "fills no area"),
        (shape(ellipse(radii=(1e-3, 1e-3))), "too small"),
        (FlatImage(np.zeros((4, 4))), "is empty"),
        (FlatImage(np.full((4, 4), 0.2), kind="silhouette"), "is empty"),
    ],
)
def test_shapes_without_area_are_refused(bad, message):
    with pytest.raises(InputError, match=message):
        frames_of([bad, shape(rectangle())], path_blends(2, 4))


@pytest.mark.parametrize(
    "make",
    [
        lambda: shape(np.zeros((2, 2))),
        lambda: shape(np.full((3, 2), np.nan)),
        lambda: shape(rectangle(), rule="winding"),
        lambda: shape(rectangle(), colors=np.zeros((2, 4))),
        lambda: shape(rectangle(), letters=(0, 1)),
        lambda: FlatImage(np.zeros(4)),
        lambda: FlatImage(np.full((2, 2), -1.0)),
        lambda: FlatImage(np.ones((2, 2)), pixel=0.0),
        lambda: FlatImage(np.ones((2, 2)), kind="photo"),
        lambda: FlatImage(np.ones((2, 2)), colors=np.zeros((2, 2, 3))),
        lambda: FlatSettings(words="syllables"),
        lambda: FlatSettings(output="pixels"),
        lambda: FlatSettings(fit_error=0.0),
    ],
)
def test_invalid_input_is_refused(make):
    with pytest.raises(InputError):
        make()


def test_letters_of_an_image_are_refused():
    with pytest.raises(InputError, match="no letters"):
        frames_of([FlatImage(np.ones((4, 4))), shape(rectangle())], path_blends(2, 4), FlatSettings(words="letters"))


def test_curves_that_cross_themselves_are_filled():
    bow = shape(np.array([[0, 0], [2, 2], [2, 0], [0, 2.0]]))
    frame = frames_of([bow, shape(rectangle())], single_blend([1, 1], 2))[0]
    interpolated = (0.5 * (np.sqrt(2) + 1)) ** 2
    assert frame.record["area_interpolated"] == pytest.approx(interpolated, rel=1e-6)
    assert interpolated < frame.outline.area < 1.2 * interpolated


def test_a_job_can_be_cancelled():
    control = CountingControl(last=6)
    with pytest.raises(Cancelled):
        frames_of([shape(ellipse()), shape(rectangle())], path_blends(2, 24), control=control)
    assert control.count < 60


def test_holes_that_belong_to_a_blend_are_not_filled():
    # A strip tears off the ring above and below: between them there is a third hole, as deep as the others.
    ring = shape(ellipse(radii=(1.4, 1.4)), ellipse(radii=(0.9, 0.9)), rule="even-odd")
    holes = [ellipse((0, y), (0.6, 0.5)) for y in (0.7, -0.7)]
    eight = shape(ellipse(radii=(1.4, 1.8)), *holes, rule="even-odd")
    (frame,) = frames_of([ring, eight], single_blend([1, 1], 2), FlatSettings(resolution=256, motion="transport"))
    assert frame.record["found"] == {"regions": 1, "holes": 3}
    assert frame.record["mended"] == {"crumbs": 0, "filled": 0, "bridged": 0}
    for mirror in ([-1, 1], [1, -1]):
        mirrored = filled_boundary([ring * mirror for ring in frame.outline.rings], "non-zero")
        own = filled_boundary(list(frame.outline.rings), "non-zero")
        one, other = (coverage(each.moved([200, 200], 100), (400, 400)) for each in (own, mirrored))
        assert np.abs(one - other).sum() < 0.01 * one.sum()
