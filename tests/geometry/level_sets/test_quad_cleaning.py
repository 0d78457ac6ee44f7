# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from convwass_addon.geometry.level_sets.dual_surface import DualSurface, dual_surface
from convwass_addon.geometry.level_sets.isosurface import surface_at_level
from convwass_addon.geometry.level_sets.quad_cleaning import without_short_edges
from convwass_addon.geometry.meshes.edges import topology
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from tests.shapes import piece_count


def triangulated(dual, first):
    """Quads cut from one of their first two corners."""
    quads = np.roll(dual.quads, -first, axis=1)
    return TriangleMesh.from_arrays(
        dual.points, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]], dual.triangles])
    )


def short_edges(dual):
    """How many pairs of corners that follow each other belong to three quads each."""
    three = np.bincount(dual.quads.ravel())[dual.quads] == 3
    return int((three & np.roll(three, -1, axis=1)).sum()) // 2


@pytest.mark.parametrize("blur", [0.4, 0.7, 1.5])
@pytest.mark.parametrize("share", [0.3, 0.5, 0.8])
def test_noise_keeps_its_topology_however_quads_are_cut(blur, share):
    noise = gaussian_filter(np.random.default_rng(5).random((24, 23, 22)), blur)
    density, level = np.pad(noise, 1), float(np.quantile(noise, share))
    drawn = surface_at_level(density, level).mesh.moved([-0.5] * 3)
    dual = dual_surface(drawn, density > level)
    cleaned = without_short_edges(dual)
    assert len(cleaned.quads) < len(dual.quads)
    for first in (0, 1):
        found, expected = topology(triangulated(cleaned, first)), topology(drawn)
        assert found.closed
        assert found.euler == expected.euler
    assert piece_count(triangulated(cleaned, 0)) == piece_count(drawn)


def grid_with_short_edge():
    """A torus of 6 x 6 quads, two neighbors of which are cut to four around a short edge between new vertices.

    Their common edge leads from p to q. Beside it lies a at the side of one quad and b at that of the other.
    """
    i, j = (index.ravel() for index in np.meshgrid(np.arange(6), np.arange(6), indexing="ij"))
    quads = np.stack([i * 6 + j, (i + 1) % 6 * 6 + j, (i + 1) % 6 * 6 + (j + 1) % 6, i * 6 + (j + 1) % 6], axis=1)
    turn, tube = 2 * np.pi * i / 6, 2 * np.pi * j / 6
    ring = 3.0 + np.cos(tube)
    points = np.stack([ring * np.cos(turn), ring * np.sin(turn), np.sin(tube)], axis=1)
    # The hexagon of the quads (2, 2) and (3, 2), whose common edge is (20, 21).
    hexagon = [14, 20, 26, 27, 21, 15]
    a, b = 36, 37
    c, d, x, e, f, y = hexagon
    filling = [(a, b, c, d), (b, a, e, f), (e, a, d, x), (c, b, f, y)]
    rest = quads[~np.isin(quads, hexagon).all(axis=1)]
    middle = points[hexagon].mean(axis=0)
    return DualSurface(
        np.concatenate([points, [middle, middle]]),
        np.zeros((38, 3), np.int64),
        np.concatenate([rest, filling]),
        np.empty((0, 3), np.int64),
    )


def test_two_quads_take_the_place_of_four():
    dual = grid_with_short_edge()
    assert topology(triangulated(dual, 0)).closed
    assert short_edges(dual) == 1
    cleaned = without_short_edges(dual)
    assert len(cleaned.quads) == len(dual.quads) - 2 == 36
    assert len(cleaned.points) == len(cleaned.cubes) == 36
    assert short_edges(cleaned) == 0
    assert topology(triangulated(cleaned, 0)).closed
    assert topology(triangulated(cleaned, 0)).euler == 0
    # The shortest cut where all others meet four quads is the grid's own.
    new = {tuple(sorted(quad)) for quad in cleaned.quads[-2:].tolist()}
    assert new == {(14, 15, 20, 21), (20, 21, 26, 27)}


def test_a_cube_is_left_alone():
    """All of its edges have two vertices of three quads, and there are not enough others."""
    density = np.zeros((5, 5, 5))
    density[2, 2, 2] = 1.0
    dual = dual_surface(surface_at_level(density, 0.5).mesh.moved([-0.5] * 3), density > 0.5)
    assert len(dual.quads) == 6
    assert len(without_short_edges(dual).quads) == 6
