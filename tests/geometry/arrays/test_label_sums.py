# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sums of vectors by label."""

from __future__ import annotations

import numpy as np

from convwass_addon.geometry.arrays.label_sums import label_sums


def test_vectors_of_a_label_are_added():
    values = np.arange(10.0).reshape(5, 2)
    found = label_sums(np.array([2, 0, 2, 0, 0]), values, 4)
    np.testing.assert_array_equal(found, [values[[1, 3, 4]].sum(axis=0), [0, 0], values[[0, 2]].sum(axis=0), [0, 0]])
