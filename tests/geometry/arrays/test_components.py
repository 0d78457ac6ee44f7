# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Connected components of small graphs."""

import numpy as np

from convwass_addon.geometry.arrays.components import component_labels


def test_nodes_are_labeled_in_the_order_of_their_components():
    np.testing.assert_array_equal(component_labels([3, 4], [1, 0], 6), [0, 1, 2, 1, 0, 3])


def test_edges_may_be_repeated():
    # So often that a count of them in eight bits becomes zero.
    labels = component_labels(np.zeros(256, np.int64), np.ones(256, np.int64), 3)
    np.testing.assert_array_equal(labels, [0, 0, 1])
    assert labels.dtype == np.int64


def test_without_edges_every_node_is_a_component():
    np.testing.assert_array_equal(component_labels([], [], 3), [0, 1, 2])
