# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from convwass_addon.applications.soft_maps.map_sides import MapSide
from convwass_addon.applications.soft_maps.mirror_maps import mirror_map_steps, mirrored_pairs
from convwass_addon.applications.soft_maps.soft_map_settings import SoftMapSettings
from convwass_addon.applications.soft_maps.transfer_shapes import ShapeCarrier
from convwass_addon.errors import InputError
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import drained
from tests.applications.maps import turn
from tests.applications.test_soft_maps import ends
from tests.shapes import ball, joined


def animal():
    """A body with four legs and two eyes; the shape is symmetric in x, its vertices are not."""
    egg = ball(1.0, points=900)
    x, y, z = egg.vertices.T
    legs = sum(np.exp(-((x - a) ** 2 + (y - b) ** 2) / 0.03) for a in (-0.45, 0.45) for b in (-0.7, 0.8))
    body = TriangleMesh(np.stack([0.6 * x, 1.4 * y, z - np.where(z < 0, legs, 0.0)], axis=1), egg.faces)
    return joined(body, ball(0.1, (-0.3, 1.5, 0.6), 120), ball(0.1, (0.3, 1.5, 0.6), 120))


def test_left_goes_right_and_shape_keys_with_it():
    mesh = animal()
    mirrored = mesh.vertices * [-1, 1, 1]
    partner = cKDTree(mesh.vertices[:900]).query(mirrored[:900])[1]
    side = np.flatnonzero(np.abs(mesh.vertices[:900, 0]) > 0.3)
    chosen = side[ends(TriangleMesh(mesh.vertices[side], mesh.faces), 4)]
    pairs = np.stack([chosen, partner[chosen]], axis=1)
    _, unique = np.unique(np.sort(pairs, axis=1), axis=0, return_index=True)
    pairs = pairs[unique]
    pairs = pairs[[len(np.intersect1d(pair, pairs)) == (np.isin(pairs, pair).sum()) for pair in pairs]]
    # In any pose and position.
    rotation = turn()
    posed = TriangleMesh(mesh.vertices @ rotation.T + [1, 2, 3], mesh.faces)
    found = drained(mirror_map_steps(MapSide(posed, "Pet"), pairs, SoftMapSettings(vertices=400, sweeps=6)))
    assert found.backward is found.forward
    away = np.linalg.norm(found.forward.positions(posed) - (mirrored @ rotation.T + [1, 2, 3]), axis=1)
    assert away[:900].mean() < 0.03 * mesh.root_area
    # The eyes are exchanged, too, although no pair names them.
    assert away[900:].max() < 0.25
    right, left = (np.clip(sign * mesh.vertices[:, :1] - 0.1, 0, None) for sign in (1, -1))
    key, expected = right * [0.1, 0.3, 0.2], left * [-0.1, 0.3, 0.2]
    offsets = ShapeCarrier.of(found.forward, posed, posed).carried(key @ rotation.T)
    miss = np.linalg.norm(offsets - expected @ rotation.T)
    assert miss < 0.25 * np.linalg.norm(expected)


def test_pairs_are_used_in_both_directions_and_central_ones_once():
    side = MapSide(animal(), "Pet")
    assert mirrored_pairs([(1, 2), (5, 5)], side).tolist() == [[1, 2], [2, 1], [5, 5]]
    assert mirrored_pairs([(1, 2), (2, 1)], side).tolist() == [[1, 2], [2, 1]]


@pytest.mark.parametrize(
    ("pairs", "message"),
    [([], "at least one pair"), ([(4, 4)], "at least one pair"), ([(1, 2), (1, 3)], "Vertex 1 of Pet is in 2 pairs")],
)
def test_without_a_left_and_a_right_there_is_no_mirror_map(pairs, message):
    with pytest.raises(InputError, match=message):
        list(mirror_map_steps(MapSide(animal(), "Pet"), pairs))
