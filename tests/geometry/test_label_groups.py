# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.label_groups import label_groups


@pytest.mark.parametrize("labels", [[], [0], [2, 0, 2, 4, 0, 2]])
def test_items_are_grouped_by_label(labels):
    labels = np.array(labels, np.int64)
    found = label_groups(labels, 5)
    assert len(found) == 5
    for label, items in enumerate(found):
        np.testing.assert_array_equal(items, np.flatnonzero(labels == label))
