# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.morphs.growing_parts import extend


@pytest.mark.parametrize("shape", [(80, 72, 80), (91, 72, 80), (151, 80, 80), (600, 83)])
def test_distances_from_a_ball_go_on_where_they_were_clipped(shape):
    """On grids that are halved once, also with odd sides, with many cells and in a plane."""
    center = np.array(shape) / 2.0
    places = np.stack(np.meshgrid(*[np.arange(n) + 0.5 for n in shape], indexing="ij"), axis=-1)
    true = 14.0 - np.linalg.norm(places - center, axis=-1)
    found = np.clip(true, -1.8, 1.8).astype(np.float32)
    extend(found, 1.75)
    near, far = np.abs(true) < 1.75, (np.abs(true) > 4.0) & (np.abs(true) < 14.0)
    np.testing.assert_allclose(found[near], true[near], atol=1e-4)
    assert (np.sign(found[far]) == np.sign(true[far])).all()
    too_short = np.abs(true[far]) - np.abs(found[far])
    assert too_short.min() > -0.8 and too_short.max() < 3.2
