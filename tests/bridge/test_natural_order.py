# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Names as Blender's lists sort them."""

from __future__ import annotations

import random

import pytest

from convwass_addon.bridge.natural_order import natural_key


@pytest.mark.parametrize(
    "names",
    [
        ["Step 1", "Step 2", "Step 10"],
        ["2", "10", "a", "a1", "a1b2", "a1b10", "a2"],
        ["Cube", "cube.001", "Cube.002", "Cube.010", "Sphere"],
        ["", " ", "x01", "x1", "x02", "x2"],
        ["ä2", "Ä10", "Ä²"],
    ],
)
def test_numbers_are_sorted_by_value(names):
    mixed = list(names)
    random.Random(0).shuffle(mixed)
    assert sorted(mixed, key=natural_key) == names
