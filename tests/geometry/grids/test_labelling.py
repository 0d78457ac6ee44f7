# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Connected components of sets of cells, compared with SciPy."""

import numpy as np
from hypothesis import given, strategies as st
from hypothesis.extra.numpy import arrays
from scipy.ndimage import label

from convwass_addon.geometry.grids.labelling import Pieces

_SETS = arrays(bool, st.tuples(*[st.integers(1, 6)] * 3))


@given(_SETS)
def test_components_agree_with_scipy(inside):
    labels, count = label(inside)
    pieces = Pieces.of(inside)
    assert pieces.count == count
    np.testing.assert_array_equal(pieces.labels, labels)


@given(_SETS)
def test_labels_of_single_cells(inside):
    pieces = Pieces.of(inside)
    np.testing.assert_array_equal(pieces.at(np.arange(inside.size)), pieces.labels.ravel())


@given(_SETS)
def test_components_away_from_the_boundary_are_renumbered(inside):
    pieces = Pieces.of(inside)
    enclosed = pieces.within()
    at_wall = np.ones(inside.shape, bool)
    at_wall[1:-1, 1:-1, 1:-1] = False
    inner = inside & ~np.isin(pieces.labels, pieces.labels[at_wall & inside])
    labels, count = label(inner)
    assert enclosed.count == count
    np.testing.assert_array_equal(enclosed.labels, labels)


def test_pairs_of_components_are_joined():
    inside = np.zeros((1, 1, 9), bool)
    inside[..., ::2] = True
    joined = Pieces.of(inside).joined(np.array([1, 4]), np.array([3, 2]))
    assert joined.labels[0, 0, ::2].tolist() == [1, 2, 1, 2, 3]
    assert joined.count == 3


@given(_SETS)
def test_cells_of_selected_components(inside):
    pieces = Pieces.of(inside)
    np.testing.assert_array_equal(pieces.sizes[1:], np.bincount(pieces.labels.ravel(), minlength=pieces.count + 1)[1:])
    wanted = np.arange(pieces.count + 1) % 2 == 1
    np.testing.assert_array_equal(pieces.cells(wanted), np.flatnonzero(wanted[pieces.labels]))
