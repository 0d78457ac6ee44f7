# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from convwass_addon.geometry.level_sets.plane_depths import plane_depths

SIZE, SAMPLES, BLUR = 20, 8, 0.7


def half_space(normal, offset):
    """The fraction of every cell that lies on one side of a plane, and the true distances; also in two dimensions."""
    normal = np.asarray(normal, float) / np.linalg.norm(normal)

    def inside(count):
        places = (np.arange(SIZE * count) + 0.5) / count - SIZE / 2
        along = np.meshgrid(*[places] * len(normal), indexing="ij")
        return offset - sum(part * axis for part, axis in zip(normal, along, strict=True))

    # Each sample is filled as a slice across the steepest axis, which is exact on average.
    filled = np.clip(inside(SAMPLES) * SAMPLES / np.abs(normal).max() + 0.5, 0.0, 1.0)
    split = filled.reshape([SIZE, SAMPLES] * len(normal))
    return split.mean(axis=tuple(range(1, 2 * len(normal), 2))).astype(np.float32), inside(1)


@pytest.mark.parametrize(
    "normal",
    [(1, 0, 0), (0, 1, 0), (1, 1, 0), (1, 1, 1), (1, 0.05, 0.02), (-0.8, 0.55, 0.27), (1, 0), (0.3, 1), (-1, 1)],
)
@pytest.mark.parametrize("offset", [0.0, 0.13, 0.5, 0.78])
def test_distances_from_planes_in_any_direction_are_exact(normal, offset):
    fractions, true = half_space(normal, offset)
    inner = np.zeros(true.shape, bool)
    inner[(slice(5, -5),) * true.ndim] = True
    for farthest, error in ((1.2, 0.02), (1.8, 0.1)):
        cells = np.flatnonzero(inner & (np.abs(true) < farthest))
        assert len(cells)
        found = plane_depths(gaussian_filter(fractions, BLUR), cells, BLUR)
        assert found == pytest.approx(true.ravel()[cells], abs=error)


def test_cells_far_from_the_surface_have_its_largest_distances():
    fractions, true = half_space((1, 0, 0), 0.0)
    cells = np.array([0, true.size - 1])
    found = plane_depths(gaussian_filter(fractions, BLUR), cells, BLUR)
    assert (np.sign(found) == np.sign(true.ravel()[cells])).all()
    assert (np.abs(found) > 1.8).all()
    assert (np.abs(found) < 3.0).all()
