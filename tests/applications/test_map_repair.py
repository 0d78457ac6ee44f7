# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from convwass_addon.applications.soft_maps.map_repair import repaired_map, repaired_points
from convwass_addon.applications.soft_maps.surface_maps import SurfaceMap
from convwass_addon.errors import InputError
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from tests.applications.maps import arm, exact_map, turn
from tests.shapes import joined, torus

ARM, _ = arm()
IDENTITY = exact_map(ARM.vertices, ARM)


def corrupted(points, bad, faces, seed=0):
    """The map with random points at some vertices, marked as unreliable."""
    noise = np.random.default_rng(seed).integers(0, faces, len(points))
    return replace(
        points,
        faces=np.where(bad, noise, points.faces).astype(np.int32),
        confidence=np.where(bad, 0.1, points.confidence).astype(np.float32),
    )


@pytest.mark.parametrize("bad", [ARM.vertices[:, 0] > 3.0, np.abs(ARM.vertices[:, 0] - 2.0) < 0.5])
def test_a_region_is_restored_even_at_the_end_of_a_limb(bad):
    """On a rotated and scaled copy: the region keeps its shape instead of becoming a film across its rim."""
    other = TriangleMesh(2.0 * ARM.vertices @ turn().T, ARM.faces)
    right = exact_map(other.vertices, other)
    found = repaired_points(corrupted(right, bad, len(ARM.faces)), ARM, other)
    np.testing.assert_allclose(found.positions(other), other.vertices, atol=1e-5)
    assert found.confidence.min() > 0.9
    np.testing.assert_array_equal(found.faces[~bad], right.faces[~bad])


def test_on_a_bent_arm_a_region_follows_the_bend():
    bent, _ = arm(1.2)
    bad = np.abs(ARM.vertices[:, 0] - 2.0) < 0.6
    found = repaired_points(corrupted(exact_map(bent.vertices, bent), bad, len(ARM.faces)), ARM, bent)
    miss = np.linalg.norm(found.positions(bent) - bent.vertices, axis=1)
    assert miss[bad].mean() < 0.06 and miss[bad].max() < 0.2


def test_both_directions_of_a_map_are_repaired_and_counted():
    bad = ARM.vertices[:, 0] > 3.5
    broken = corrupted(IDENTITY, bad, len(ARM.faces))
    found = repaired_map(SurfaceMap(broken, IDENTITY, None), ARM, ARM)
    np.testing.assert_allclose(found.forward.positions(ARM), ARM.vertices, atol=1e-5)
    np.testing.assert_array_equal(found.backward.faces, IDENTITY.faces)
    (notice,) = found.notices
    assert notice.values["count"] == (broken.faces != found.forward.faces).sum() > 50


def test_components_without_reliable_points_and_good_maps_are_unchanged():
    assert repaired_points(IDENTITY, ARM, ARM) is IDENTITY
    both = joined(ARM, torus(center=(0, 5, 0), segments=(24, 12)))
    points = exact_map(both.vertices, both)
    bad = np.arange(len(both.vertices)) >= len(ARM.vertices)
    broken = corrupted(points, bad | (both.vertices[:, 0] > 3.5), len(both.faces))
    found = repaired_points(broken, both, both)
    np.testing.assert_array_equal(found.faces[bad], broken.faces[bad])
    np.testing.assert_allclose(found.positions(both)[~bad], both.vertices[~bad], atol=1e-5)


def test_maps_that_cannot_be_repaired_are_refused():
    with pytest.raises(InputError, match="between 0 and 1"):
        repaired_points(IDENTITY, ARM, ARM, 1.5)
    with pytest.raises(InputError, match="other meshes"):
        repaired_points(IDENTITY, torus(), ARM)
    nothing = replace(IDENTITY, confidence=np.zeros_like(IDENTITY.confidence))
    with pytest.raises(InputError, match="No point of the map"):
        repaired_points(nothing, ARM, ARM, 0.5)
