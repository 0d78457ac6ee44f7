# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Representations of records and domains fit on one line; argument errors are also ValueErrors."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

from convwass_addon.applications.morphs.layouts import Blend
from convwass_addon.applications.morphs.morph_problem import MorphFrame
from convwass_addon.errors import ConvwassError, InputError
from convwass_addon.transport import (
    Grid,
    Inputs,
    Sphere,
    Surface,
    barycenter,
    barycentric_coordinates,
    bisect,
    distance,
    distance_matrix,
    interpolate,
    nearest_barycenter,
    propagate,
)
from tests.shapes import box

GRID = Grid((6, 7), 1.0)
MUS = np.random.default_rng(1).random((2, 6, 7))
SHOWN = [
    GRID,
    Sphere(8, 1.25),
    Surface(box().vertices, box().faces),
    box(),
    Inputs.of(MUS, GRID),
    barycenter(MUS, [1.0, 3.0], GRID),
    barycenter(MUS, [1.0, 3.0], GRID).levels[-1],
    interpolate(*MUS, np.linspace(0, 1, 9), GRID),
    bisect(*MUS, GRID, levels=2),
    distance(*MUS, GRID),
    distance_matrix(MUS, GRID),
    propagate([[0, 1]], 1.0, {0: MUS[0]}, GRID),
    barycentric_coordinates(MUS[0], MUS, GRID),
    nearest_barycenter(MUS[0], MUS, GRID, max_evaluations=2),
]


@pytest.mark.parametrize("record", SHOWN, ids=lambda record: type(record).__name__)
def test_the_representation_of_a_record_fits_on_a_line(record):
    shown = repr(record)
    assert shown.startswith(f"{type(record).__name__}(")
    assert shown.endswith(")")
    assert "\n" not in shown
    assert len(shown) <= 160


def test_representations_show_the_essentials():
    assert repr(GRID) == "Grid(shape=(6, 7), sigma=1, boundary='open')"
    assert repr(box()) == "TriangleMesh(vertices=<float64 (8, 3)>, faces=<int64 (12, 3)>)"
    assert repr(SHOWN[5]).startswith("Barycenter(density=<float64 (6, 7)>, weights=[0.25, 0.75], iterations=(")
    assert repr(SHOWN[5]).endswith("converged=True)")


def test_argument_errors_are_value_errors():
    with pytest.raises(ValueError, match="do not exist"):
        Surface(np.zeros((3, 3)), [[0, 1, 5]])
    error = pickle.loads(pickle.dumps(InputError("{name} has no faces.", name="A")))
    assert isinstance(error, ConvwassError)
    assert isinstance(error, ValueError)
    assert str(error) == "A has no faces."


def test_nested_records_show_only_their_type():
    frame = MorphFrame(Blend((0.5, 0.5)), box(), {}, origins=np.zeros((2, 8, 3), np.float32))
    assert repr(frame) == (
        "MorphFrame(blend=Blend(weights=(0.5, 0.5), frame=None, place=(0.0, 0.0)), mesh=<TriangleMesh>, "
        "origins=<float32 (2, 8, 3)>)"
    )
