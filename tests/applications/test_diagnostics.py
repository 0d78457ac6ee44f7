# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Diagnostics of bakes with known faults."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given, strategies as st

from convwass_addon.applications.morphs.diagnostics import (
    TEXTS,
    Diagnostic,
    diagnose,
    diagnostic_figures,
    finer,
    listed,
)
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.morphs.thin_shapes import thin_parts, wall_share
from convwass_addon.geometry.solids.occupancy import occupancy

from ..shapes import ball, box, joined

SETTINGS = MorphSettings(motion="transport", resolution=64).as_dict()
GOOD = {"converged": True, "marginal_error": 0.005, "sigma": 1.0, "wall": 0.0}


def kinds(records, settings=SETTINGS, names=("Cow", "Duck"), numbers=None):
    return [note.kind for note in diagnose(records, settings, names, numbers)]


def lost(share, thickness=1.3, length=14.0):
    part = {"thickness": thickness, "length": length, "share": share}
    return {"share": share, "scattered": 0.0, "count": 1, "parts": [part]}


def body_with_leg(thickness, cells=(48, 32, 32)):
    """Occupancy of a ball of 9 cells' radius with a square leg of 16 cells."""
    middle = np.array([14.0, 16.0, 16.0])
    mesh = joined(ball(9.0, middle), box((20.0, thickness, thickness), middle + np.array([16.0, 0.0, 0.0])))
    return occupancy(mesh.corners, cells)


def test_a_good_bake_is_reported_as_good():
    assert kinds([GOOD, GOOD]) == ["GOOD"]
    assert kinds([]) == ["GOOD"]


def test_unconverged_frames_are_listed_with_the_largest_error():
    slack = {"converged": False, "marginal_error": 0.034}
    note = diagnose([GOOD, GOOD | slack, GOOD | slack | {"marginal_error": 0.02}, GOOD], SETTINGS, ["A", "B"])[0]
    assert note.severity == "ERROR"
    assert note.text == "Less exact than asked for in 2-3, by up to 3.4%: try more blur"


def test_lost_parts_are_measured_and_a_resolution_is_proposed():
    note = diagnose([GOOD, GOOD | {"lost": lost(0.021)}], SETTINGS, ["A", "B"], [10, 11])[0]
    assert note.text == "Parts 1.3 cells thick and 14 long are lost in 11, up to 2.1% of the shape: try resolution 104"
    assert kinds([GOOD | {"lost": lost(0.0005)}]) == ["GOOD"]


def test_additional_pieces_and_holes_are_reported():
    most = {"pieces": 1, "handles": 0, "bubbles": 0}
    torn = GOOD | {"found": most | {"pieces": 3, "handles": 1}, "most": most}
    notes = diagnose([GOOD, torn, GOOD | {"found": most, "most": most}], SETTINGS, ["A", "B"])
    assert [note.text for note in notes] == [
        "Torn into up to 3 pieces in 2, where the shapes have 1: try another motion",
        "Up to 1 more holes than the shapes have in 2, where parts meet on the way",
    ]
    assert kinds([GOOD | {"found": {"regions": 2, "holes": 0}}]) == ["GOOD"]


def test_mass_at_the_wall_is_reported():
    assert kinds([GOOD | {"wall": 0.004}]) == ["WALL"]
    assert kinds([GOOD | {"wall": 1e-5}]) == ["GOOD"]


def test_the_wall_is_the_outermost_layer_of_cells():
    density = np.ones((4, 5, 6))
    assert wall_share(density) == pytest.approx(1 - 2 * 3 * 4 / 120)
    density[[0, -1]] = density[:, [0, -1]] = density[:, :, [0, -1]] = 0.0
    assert wall_share(density) == 0.0


def test_an_automatically_widened_blur_is_reported():
    assert kinds([GOOD, GOOD | {"sigma": 1.5625}]) == ["WIDENED"]
    assert kinds([GOOD | {"sigma": 3.0}], SETTINGS | {"blur": 3.0}) == ["GOOD"]
    # Flat shapes are blurred less than solids of the same resolution.
    flat = {"sigma_wanted": 2.0}
    assert kinds([GOOD | flat | {"sigma": 2.5}], SETTINGS | {"resolution": 200}) == ["WIDENED"]
    assert kinds([GOOD | flat | {"sigma": 2.0}], SETTINGS | {"resolution": 200}) == ["GOOD"]
    assert kinds([GOOD | {"sigma": 2.0}], MorphSettings(motion="transport", resolution=160).as_dict()) == ["GOOD"]


def test_notices_about_parts_are_passed_on_once():
    notes = diagnose([GOOD | {"notices": (("TOO_SMALL", "Tail"),)}] * 3, SETTINGS, ["A", "B"])
    assert [note.text for note in notes] == ["Tail is too small at this resolution and travels with the rest."]


@pytest.mark.parametrize(
    "notices", ["TOO_SMALL", 3, [3], [["TOO_SMALL"]], [["GOOD", "Tail"]], [[["TOO_SMALL"], "Tail"]]]
)
def test_invalid_notices_are_left_out(notices):
    assert kinds([GOOD | {"notices": notices}]) == ["GOOD"]


@pytest.mark.parametrize("thickness", [1.2, 1.5])
def test_thin_legs_are_measured_in_cells(thickness):
    found = thin_parts(body_with_leg(thickness))
    assert len(found["parts"]) == 1
    # A square rod has the thickness of a round one of the same section.
    assert found["parts"][0]["thickness"] == pytest.approx(thickness * 2 / np.sqrt(np.pi), rel=0.1)
    assert found["parts"][0]["length"] == pytest.approx(14, abs=3)


def test_legs_of_a_fraction_of_a_cell_are_noticed():
    (part,) = thin_parts(body_with_leg(0.5))["parts"]
    assert part["thickness"] == 0.5
    assert part["length"] == pytest.approx(14, abs=3)


def test_an_antenna_of_hardly_any_volume_is_noticed_because_it_is_seen():
    shape = body_with_leg(0.2)
    found = thin_parts(shape)
    assert found["share"] < 1e-3
    assert diagnose([{"input": 0, "thin": found}], SETTINGS, ["Cow", "Duck"])[0].kind == "TOO_COARSE"
    # The ball ends at 23 cells.
    shape[25:] = 0.0
    assert thin_parts(shape)["parts"] == ()


@pytest.mark.parametrize(
    "shape", [body_with_leg(4.0), occupancy(box((20, 20, 20), (16, 16, 16)).corners, (32, 32, 32))]
)
def test_thick_parts_and_edges_are_no_thin_parts(shape):
    assert thin_parts(shape) == {"share": 0, "parts": ()}


def test_a_shape_without_thick_parts_is_reported():
    sheet = occupancy(box((20, 20, 1.0), (16, 16, 8.5)).corners, (32, 32, 16))
    found = thin_parts(sheet)
    assert found["share"] == 1.0
    assert found["parts"][0]["thickness"] == pytest.approx(1.0, abs=0.2)
    for thickness in (0.48, 0.2, 0.1):
        halved = thin_parts(occupancy(box((20, 20, thickness), (16, 16, 8.0)).corners, (32, 32, 16)))
        assert halved["parts"][0]["thickness"] == pytest.approx(thickness, rel=0.2)
        assert halved["parts"][0]["length"] == pytest.approx(20, abs=1)
    thick_enough = occupancy(box((20, 20, 2.2), (16, 16, 8.0)).corners, (32, 32, 16))
    assert thin_parts(thick_enough)["parts"] == ()


def test_too_coarse_for_the_legs_of_the_cow():
    record = {"input": 0, "thin": thin_parts(body_with_leg(1.1))}
    note = diagnose([record], SETTINGS, ["Cow", "Duck"])[0]
    assert note.text.startswith("Resolution 64 is too coarse for thin parts of Cow (1.")
    assert note.values["better"] in (104, 112)
    assert thin_parts(body_with_leg(1.1 * note.values["better"] / 64, (64, 32, 32)))["parts"] == ()


def test_reduced_figures_give_the_same_diagnostics_after_json():
    record = GOOD | {"lost": lost(0.05), "input": 1, "thin": thin_parts(body_with_leg(1.2))}
    flat = {name: value for name, value in record.items() if not isinstance(value, dict)} | diagnostic_figures(record)
    assert diagnose([json.loads(json.dumps(flat))], SETTINGS, ["A", "B"]) == diagnose([record], SETTINGS, ["A", "B"])


def test_damaged_figures_are_taken_as_good():
    assert kinds([{"lost_share": None, "wall": "much", "sigma": None, "input": 7, "thin_thickness": 1.0}]) == ["GOOD"]


@pytest.mark.parametrize(
    ("motion", "expected"),
    [
        ({"kind": "guided", "reason": "FITS", "score": 0.91}, ["GOOD", "GUIDED"]),
        ({"kind": "guided", "reason": "PARTLY", "score": 0.6, "left": 0.2}, ["GOOD", "PARTLY"]),
        ({"kind": "combined", "reason": "UNLIKE", "score": 0.5}, ["GOOD", "COMBINED"]),
        ({"kind": "warp", "reason": "UNLIKE", "score": 0.74}, ["GOOD", "CLOSER"]),
        ({"kind": "warp", "reason": "CRUMPLED", "score": 0.52, "left": 0.4}, ["GOOD", "CRUMPLED"]),
        ({"kind": "warp", "reason": "TUMBLING", "score": 0.2, "left": 0.6}, ["GOOD", "UPRIGHT"]),
        ({"kind": "transport", "reason": "TUMBLING", "score": 0.57, "left": 1.2}, ["GOOD", "TUMBLING"]),
        ({"kind": "warp", "reason": "APART", "score": 0.2, "detour": 1.7, "left": 0.3}, ["GOOD", "WARPED"]),
        ({"kind": "guided", "reason": "VERTICES", "score": 1.0}, ["GOOD", "VERTICES"]),
        ({"kind": "guided", "reason": "OUTLINES"}, ["GOOD", "OUTLINES"]),
        ({"kind": "guided", "reason": "TUBES"}, ["GOOD", "TUBES"]),
        ({"kind": "guided", "reason": "OUTLINES", "turned": 180}, ["GOOD", "OUTLINES_TURNED"]),
        ({"kind": "transport", "reason": "REGIONS"}, ["GOOD", "REGIONS"]),
        ({"kind": "transport", "reason": "DISTORTED"}, ["GOOD", "DISTORTED"]),
        ({"kind": "warp", "reason": "SOLID", "left": 0.3}, ["GOOD", "MERGED"]),
        ({"kind": "transport", "reason": "APART", "score": 0.2, "detour": 1.7}, ["GOOD", "APART"]),
        ({"kind": "transport", "reason": "FAILED", "failure": "no map"}, ["GOOD", "NO_MOTION"]),
        ({"kind": "transport", "reason": "SOLID"}, ["GOOD", "SOLID"]),
        ({"kind": "guided", "reason": "ASKED", "score": 0.91}, ["GOOD"]),
        ({"kind": "guided", "reason": "FITS", "score": 0.91, "turned": 90}, ["GOOD", "GUIDED", "TURNED"]),
        ({"kind": "guided", "reason": "ASKED", "score": 0.91, "guides_left_out": 2}, ["GOOD", "GUIDES"]),
        ({"kind": "transport", "reason": "ASKED"}, ["GOOD"]),
    ],
)
def test_the_chosen_motion_is_reported(motion, expected):
    """Also from the figures that are stored with a frame."""
    record = {"motion": motion}
    assert kinds([record]) == expected
    assert kinds([diagnostic_figures(record)]) == expected


def test_every_template_can_be_filled():
    values = {"resolution": 64, "name": "{x}", "cells": 1.0, "better": 96, "frames": "1-2", "share": 0.1}
    values |= {"thickness": 1.0, "length": 3.0, "error": 0.1, "sigma": 2.0, "text": "x", "score": 0.8, "failure": "x"}
    values |= {"pieces": 3, "most": 1, "holes": 2, "materials": "x", "names": "x", "sockets": "x"}
    values |= {"angle": 90.0, "detour": 1.7, "count": 2}
    for kind in TEXTS:
        assert Diagnostic(kind, values).text


@given(st.sets(st.integers(0, 60)))
def test_listed_numbers_are_all_there(numbers):
    spans = [span.split("-") for span in listed(numbers).split(", ") if span]
    assert {n for span in spans for n in range(int(span[0]), int(span[-1]) + 1)} == numbers


@given(st.integers(16, 512), st.floats(0.2, 1.99))
def test_a_finer_resolution_makes_thin_parts_thick_enough(resolution, cells):
    better = finer(resolution, cells)
    assert better > resolution or better == max(512, resolution)
    assert better == 512 or better * cells / resolution >= 2.0
