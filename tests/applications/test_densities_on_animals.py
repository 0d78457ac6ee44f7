# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Densities on the project's own animals: they travel along the skin and never through the air."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from convwass_addon.applications.densities.density_measures import MEASURING_SUBSTEPS
from convwass_addon.applications.densities.density_paths import interpolation_steps
from convwass_addon.applications.densities.density_settings import DensitySettings
from convwass_addon.applications.densities.surface_densities import density_surface
from convwass_addon.applications.densities.vertex_distances import distances_from
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import drained

SHAPES = Path(__file__).parents[2] / "assets" / "shapes"


@cache
def horse():
    """Read the horse from its file: float32 positions, then triangles, each preceded by its vertex count."""
    data = (SHAPES / "horse.ply").read_bytes()
    header, _, body = data.partition(b"end_header\n")
    counts = [int(line.split()[-1]) for line in header.splitlines() if line.startswith(b"element")]
    vertices = np.frombuffer(body, "<f4", 3 * counts[0]).reshape(-1, 3)
    triangles = np.dtype([("count", "u1"), ("corners", "<u4", 3)])
    faces = np.frombuffer(body, triangles, counts[1], vertices.nbytes)["corners"]
    return TriangleMesh.from_arrays(vertices, faces)


def edge_path_lengths(mesh, vertices):
    """Lengths of the shortest paths along edges from vertices to all others, (k, n)."""
    tails, heads = mesh.faces.ravel(), np.roll(mesh.faces, -1, axis=1).ravel()
    lengths = np.linalg.norm(mesh.vertices[tails] - mesh.vertices[heads], axis=1)
    # In a closed mesh, every edge appears in both directions.
    graph = coo_array((lengths, (tails, heads)), shape=(len(mesh.vertices),) * 2).tocsr()
    return dijkstra(graph, indices=vertices)


def hoof(mesh, side):
    """The lowest vertex of the hind leg of a side."""
    x, y, z = mesh.vertices.T
    own = np.flatnonzero((x < 0) & (y * side > 0))
    return int(own[z[own].argmin()])


@pytest.mark.parametrize("entropy_limit", ["max", None])
def test_from_hoof_to_hoof_the_path_is_up_one_leg_and_down_the_other(entropy_limit):
    """The corridor, a fifth of the horse, holds all points on edge paths of up to 1.3 times the shortest length.

    With bounded entropy, less than 1e-4 of the mass ever leaves it; without, 2 %. The difference of the mean distances
    from both ends shows that the mass is where it should be.
    """
    mesh = horse()
    surface = density_surface(mesh)
    ends = [hoof(mesh, 1), hoof(mesh, -1)]
    here, there = edge_path_lengths(mesh, ends)
    whole = here[ends[1]]
    assert whole > 3 * np.linalg.norm(mesh.vertices[ends[0]] - mesh.vertices[ends[1]])
    paint = [np.where(way < 0.15 * whole, 1.0, 0.0) for way in (here, there)]
    frames = drained(interpolation_steps(*paint, surface, DensitySettings(steps=8, entropy_limit=entropy_limit)))
    mass = frames.densities * surface.weights
    np.testing.assert_allclose(mass.sum(axis=1), 1.0)
    corridor = here + there < 1.3 * whole
    assert corridor @ surface.weights < 0.2
    assert (mass @ corridor).min() > (0.999 if entropy_limit else 0.975)
    assert all(figures["converged"] for figures in frames.records)
    if entropy_limit:
        places = mass @ (here - there) / whole
        # The mean of paint on a hoof lies slightly up the leg; steps near the ends are shorter.
        np.testing.assert_allclose(places[1:-1], np.linspace(places[0], places[-1], 9)[1:-1], atol=0.09)
        entropies = np.array([figures["entropy"] for figures in frames.records])
        assert (frames.densities.max(axis=1) / np.exp(1.0 - entropies)).max() < 1.4


def test_distances_along_the_skin_are_those_along_edges():
    """Measured 4 % less halfway: edge paths are too long, and heat that a leg confines makes points seem nearer."""
    mesh = horse()
    surface = density_surface(mesh, substeps=MEASURING_SUBSTEPS)
    source = hoof(mesh, 1)
    (edges,) = edge_path_lengths(mesh, [source])
    far = edges > 0.3
    ratio = distances_from(source, surface).lengths[far] / edges[far]
    low, middle, high = np.percentile(ratio, [5, 50, 95])
    assert low > 0.9
    assert middle == pytest.approx(0.96, abs=0.02)
    assert high < 1.05
