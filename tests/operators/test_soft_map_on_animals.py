# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""From two horses with different meshes and poses to weights and shape keys, as a rigger works."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest

from convwass_addon.bridge.element_values import element_values
from convwass_addon.bridge.soft_maps.soft_map_store import stored_soft_map
from convwass_addon.bridge.vertex_groups import read_group, write_group
from tests.operators.running import call
from tests.operators.soft_maps import choose, own, points

pytestmark = pytest.mark.usefixtures("empty_scene")

HORSE = Path(__file__).parents[2] / "assets" / "shapes" / "horse.ply"


def bent(places):
    """Bend along the back and shear, which moves legs and head by half of their size."""
    x, y, z = places.T
    angle = 0.9 * x / np.ptp(x)
    return np.stack([x * np.cos(angle) - 0.6 * z * np.sin(angle), y + 0.15 * x, z + x * np.sin(angle)], axis=1)


def horse(name, share, move=None):
    """Import the horse, move its vertices, and decimate it; its rest positions are kept as an attribute."""
    bpy.ops.wm.ply_import(filepath=str(HORSE))
    obj = bpy.context.object
    obj.name = name
    obj.matrix_basis.identity()
    rest = points(obj)
    attribute = obj.data.attributes.new("rest", "FLOAT_VECTOR", "POINT")
    attribute.data.foreach_set("vector", rest.astype(np.float32).ravel())
    if move is not None:
        obj.data.vertices.foreach_set("co", move(rest).astype(np.float32).ravel())
    modifier = obj.modifiers.new("Decimate", "DECIMATE")
    modifier.ratio = share
    bpy.ops.object.modifier_apply(modifier="Decimate")
    return obj


def rest_of(obj):
    return element_values(obj.data.attributes["rest"].data, "vector", 3).astype(np.float64)


def nearest(obj, place):
    return int(np.linalg.norm(rest_of(obj) - place, axis=1).argmin())


def test_from_two_horses_to_weights_and_shape_keys():
    source, target = horse("Source", 0.5), horse("Target", 0.4, bent)
    choose(source, target)
    rest = rest_of(source)
    # The hooves and the ends of head and tail: the extremes along some directions.
    for direction in ((1, 0, 0), (-1, 0, 0), (1, 1, -2), (1, -1, -2), (-1, 1, -2), (-1, -1, -2), (1, 0, 2)):
        place = rest[(rest / np.ptp(rest, axis=0) @ direction).argmax()]
        call("add_map_pair", source_vertex=nearest(source, place), target_vertex=nearest(target, place))
    assert call("compute_soft_map") == {"FINISHED"}
    assert len(own().pairs) == 7
    found = stored_soft_map(source, target).found
    size = np.linalg.norm(np.ptp(rest, axis=0))
    images = np.einsum(
        "nk,nkd->nd",
        found.backward.barycentric,
        rest[stored_soft_map(source, target).source.triangles[found.backward.faces]],
    )
    errors = np.linalg.norm(images - rest_of(target), axis=1) / size
    assert np.median(errors) < 0.02
    assert (errors < 0.06).mean() > 0.9
    front = np.clip((rest[:, 0] - rest[:, 0].min()) / np.ptp(rest[:, 0]), 0, 1)
    write_group(source, "Front", front)
    write_group(source, "Back", 1 - front)
    source.shape_key_add(name="Basis")
    key = source.shape_key_add(name="Fat", from_mix=False)
    swelling = np.stack([np.zeros(len(rest)), 0.3 * rest[:, 1], np.zeros(len(rest))], axis=1)
    key.data.foreach_set("co", (rest + swelling).astype(np.float32).ravel())
    assert call("transfer_by_map", what={"GROUPS", "KEYS"}) == {"FINISHED"}
    expected = np.clip((rest_of(target)[:, 0] - rest[:, 0].min()) / np.ptp(rest[:, 0]), 0, 1)
    got = read_group(target, "Front")
    assert np.median(np.abs(got - expected)) < 0.02
    np.testing.assert_allclose(got + read_group(target, "Back"), 1.0, atol=1e-5)
    offsets = element_values(target.data.shape_keys.key_blocks["Fat"].data, "co", 3) - points(target)
    side = rest_of(target)[:, 1]
    wide = np.abs(side) > 0.5 * np.abs(side).max()
    assert np.median((offsets[wide, 1] * np.sign(side[wide])) / (0.3 * np.abs(side[wide]))) == pytest.approx(
        1.0, abs=0.2
    )
