# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Maps are stored with their source object without loss, and damaged ones are refused with the reason."""

from __future__ import annotations

import json
import random
import zlib
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import bpy
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from convwass_addon.array_files import ArrayReader, array_bytes
from convwass_addon.bridge.soft_maps.soft_map_bytes import MappedSide, MeshMark, StoredSoftMap, packed, unpacked
from convwass_addon.bridge.soft_maps.soft_map_store import (
    MAPS_KEY,
    MapState,
    forget_soft_map,
    has_soft_map,
    map_state,
    mapped_side,
    recounted,
    store_soft_map,
    stored_soft_map,
)
from convwass_addon.bridge.surfaces import surface_mesh
from convwass_addon.errors import InputError
from tests.shapes import box
from tests.surface_maps import closest_map


def ball(name, segments=16, scale=1.0):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=segments, ring_count=8)
    obj = bpy.context.object
    obj.name = name
    obj.scale = (scale,) * 3
    return obj


def stored_between(source, target):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    meshes = [surface_mesh(obj, depsgraph) for obj in (source, target)]
    sides = [mapped_side(obj, mesh.faces) for obj, mesh in zip((source, target), meshes, strict=True)]
    return StoredSoftMap(closest_map(*meshes), *sides)


@pytest.fixture
def pair():
    return ball("Source"), ball("Target", segments=12)


def assert_same(stored, other):
    for way in ("forward", "backward"):
        one, two = getattr(stored.found, way), getattr(other.found, way)
        np.testing.assert_array_equal(one.faces, two.faces)
        np.testing.assert_allclose(one.barycentric, two.barycentric, atol=2e-5)
    assert_same_but_for_places(stored, other)


def assert_same_but_for_places(stored, other):
    for way in ("forward", "backward"):
        one, two = getattr(stored.found, way), getattr(other.found, way)
        assert np.abs(two.barycentric.sum(axis=1) - two.found).max() < 1e-6
        for name in ("spread", "entropy", "confidence"):
            np.testing.assert_allclose(getattr(one, name), getattr(two, name), rtol=1e-3)
    rows, others = stored.found.coarse, other.found.coarse
    np.testing.assert_array_equal(rows.starts, others.starts)
    np.testing.assert_array_equal(rows.columns, others.columns)
    np.testing.assert_allclose(rows.values, others.values, rtol=1e-3)
    for side in ("source", "target"):
        np.testing.assert_array_equal(getattr(rows, side).columns, getattr(others, side).columns)
        np.testing.assert_allclose(getattr(rows, side).shares, getattr(others, side).shares, atol=2e-5)
        np.testing.assert_array_equal(getattr(stored, side).triangles, getattr(other, side).triangles)
        assert getattr(stored, side).mark == getattr(other, side).mark
    assert stored.found.record == other.found.record
    assert list(map(str, stored.found.notices)) == list(map(str, other.found.notices))


def test_a_map_comes_back_after_saving(pair, tmp_path):
    source, target = pair
    stored = stored_between(*pair)
    store_soft_map(source, target, stored)
    assert_same(stored, stored_soft_map(source, target))
    path = str(tmp_path / "a.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    source, target = bpy.data.objects["Source"], bpy.data.objects["Target"]
    assert_same(stored, stored_soft_map(source, target))
    target.name = "Renamed"
    assert has_soft_map(source, target)


def test_vertices_without_an_image_come_back_as_such(pair):
    stored = stored_between(*pair)
    forward = stored.found.forward
    faces, spread = forward.faces.copy(), forward.spread.copy()
    barycentric = forward.barycentric.copy()
    faces[3], spread[3], barycentric[3] = -1, np.inf, 0.0
    lone = replace(forward, faces=faces, spread=spread, barycentric=barycentric)
    stored = StoredSoftMap(replace(stored.found, forward=lone), stored.source, stored.target)
    assert_same(stored, unpacked(packed(stored)))
    assert unpacked(packed(stored)).found.forward.spread[3] == np.inf


def test_stored_maps_are_compact():
    """Less than 60 bytes a vertex, of the 300 that the arrays take."""
    source, target = ball("Source", segments=150), ball("Target", segments=150)
    data = packed(stored_between(source, target))
    assert len(data) < 60 * (len(source.data.vertices) + len(target.data.vertices))


def test_maps_to_several_targets(pair):
    source, target = pair
    other = ball("Other", segments=10)
    store_soft_map(source, target, stored_between(source, target))
    store_soft_map(source, other, stored_between(source, other))
    store_soft_map(source, target, stored_between(source, target))
    assert len(source[MAPS_KEY]) == 2
    assert len(stored_soft_map(source, other).found.backward) == len(other.data.vertices)
    assert not has_soft_map(target, source)
    copied = source.copy()
    assert has_soft_map(copied, target)
    forget_soft_map(source, target)
    assert (has_soft_map(source, target), has_soft_map(source, other)) == (False, True)
    forget_soft_map(source, other)
    assert MAPS_KEY not in source
    with pytest.raises(InputError, match="Source has no soft map to Target; compute it first"):
        stored_soft_map(source, target)


def test_maps_to_deleted_objects_are_dropped(pair):
    source, target = pair
    store_soft_map(source, target, stored_between(source, target))
    bpy.data.objects.remove(target)
    other = ball("Other")
    assert not has_soft_map(source, other)
    store_soft_map(source, other, stored_between(source, other))
    assert len(source[MAPS_KEY]) == 1


def test_changes_of_the_meshes_are_noticed(pair):
    source, target = pair
    stored = stored_between(source, target)
    store_soft_map(source, target, stored)
    assert (map_state(source, stored.source), recounted(source, target)) == (MapState.CURRENT, [])
    source.location.x = 5
    source.modifiers.new("Smooth", "SMOOTH")
    assert map_state(source, stored.source) is MapState.CURRENT
    source.data.vertices[3].co.x += 0.5
    assert map_state(source, stored.source) is MapState.RESHAPED
    bpy.context.view_layer.objects.active = target
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.flip_normals()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert (map_state(target, stored.target), recounted(source, target)) == (MapState.OTHER, [])
    target.data.vertices.add(1)
    assert recounted(source, target) == ["Target"]


@pytest.mark.parametrize(
    "value",
    [3, "text", [1, 2], {"0": 3}, {"0": {"target": None}}, {"0": {"data": b"x"}}],
    ids=str,
)
def test_something_else_under_the_key_is_no_map(pair, value):
    source, target = pair
    source[MAPS_KEY] = value
    assert not has_soft_map(source, target)
    assert recounted(source, target) == []
    with pytest.raises(InputError, match="no soft map"):
        stored_soft_map(source, target)
    store_soft_map(source, target, stored_between(source, target))
    assert has_soft_map(source, target)


def with_header(data, change):
    """The same map with another header, sealed anew."""
    reader = ArrayReader(BytesIO(data), 1 << 30)
    with np.load(BytesIO(data)) as arrays:
        planes = {name: arrays[name] for name in arrays.files if name != "header.json"}
    change(reader.header)
    return array_bytes(planes, reader.header, 6)


@pytest.mark.parametrize(
    "change",
    [
        lambda header: header.update(schema=3),
        lambda header: header.update(sides=[]),
        lambda header: header["sides"][0].update(vertices="many"),
        lambda header: header["sides"][0].update(more=1),
        lambda header: header.update(record=[]),
        lambda header: header.update(notices=[[1, {}]]),
        lambda header: header.update(notices=[["{a}", {}, 3]]),
        lambda header: header.clear(),
    ],
)
def test_damaged_headers_are_refused(pair, change):
    source, target = pair
    store_soft_map(source, target, stored_between(source, target))
    entry = source[MAPS_KEY]["0"]
    entry["data"] = with_header(entry["data"], change)
    with pytest.raises(InputError, match=r"is damaged .*; compute it again"):
        stored_soft_map(source, target)


@pytest.mark.parametrize("data", [None, "text", b"", b"CWMAP\x00", b"CWMAP\x00\xff\xff\xff\x7f{}", b"other bytes"])
def test_other_bytes_are_refused(pair, data):
    source, target = pair
    store_soft_map(source, target, stored_between(source, target))
    if data is None:
        del source[MAPS_KEY]["0"]["data"]
    else:
        source[MAPS_KEY]["0"]["data"] = data
    with pytest.raises(InputError, match="damaged"):
        stored_soft_map(source, target)


FIRST_SCHEMA = Path(__file__).with_name("soft_map_schema_1.bin").read_bytes()
"""What the first version made of a map between two boxes."""


def test_maps_of_the_version_before_are_read():
    source, target = box((1.0, 1.1, 0.9)), box()
    sides = [
        MappedSide(MeshMark(8, 6, f"topology {name}", f"shape {name}"), mesh.faces)
        for name, mesh in (("a", source), ("b", target))
    ]
    expected, found = StoredSoftMap(closest_map(source, target), *sides), unpacked(FIRST_SCHEMA)
    assert_same_but_for_places(expected, found)
    # Corners of boxes are as close to several faces, of which any may be found.
    for way, onto in (("forward", target), ("backward", source)):
        places = [
            np.einsum("nk,nkd->nd", own.barycentric, onto.vertices[onto.faces[own.faces]])
            for own in (getattr(expected.found, way), getattr(found.found, way))
        ]
        np.testing.assert_allclose(*places, atol=1e-4)


def first_schema_parts():
    start = len(b"CWMAP\x00") + 4
    length = int.from_bytes(FIRST_SCHEMA[start - 4 : start], "little")
    return json.loads(FIRST_SCHEMA[start : start + length]), FIRST_SCHEMA[start + length :]


@pytest.mark.parametrize(
    "change",
    [
        lambda header: header.update(schema=2),
        lambda header: header.pop("shapes"),
        lambda header: header["shapes"].pop(),
        lambda header: header["shapes"][0].__setitem__(0, 10**12),
        lambda header: header["shapes"][0].__setitem__(0, -1),
        lambda header: header["shapes"][0].__setitem__(0, header["shapes"][0][0] - 1),
        lambda header: header.clear(),
    ],
)
def test_damaged_maps_of_the_version_before_are_refused(change):
    header, body = first_schema_parts()
    change(header)
    text = json.dumps(header).encode()
    with pytest.raises((ValueError, KeyError)):
        unpacked(b"CWMAP\x00" + len(text).to_bytes(4, "little") + text + body)


def test_a_bomb_is_not_unpacked():
    """Compressed zeros beyond the size in the header."""
    _, body = first_schema_parts()
    bomb = FIRST_SCHEMA[: -len(body)] + zlib.compress(zlib.decompress(body) + bytes(10**7))
    with pytest.raises(ValueError, match="bytes where"):
        unpacked(bomb)


@pytest.mark.parametrize(
    ("place", "value"),
    [
        ("found.forward.faces", 10**6),
        ("found.backward.faces", -2),
        ("found.coarse.columns", 10**6),
        ("found.coarse.starts", 7),
        ("found.coarse.source.columns", 10**6),
        ("found.coarse.target.columns", -1),
        ("found.coarse.values", np.inf),
        ("found.forward.spread", np.nan),
        ("source.triangles", 10**6),
    ],
)
def test_numbers_that_lead_nowhere_are_refused(pair, place, value):
    stored = stored_between(*pair)
    owner, names = stored, place.split(".")
    for name in names[:-1]:
        owner = getattr(owner, name)
    array = np.array(getattr(owner, names[-1]))
    array.flat[-1 if names[-1] == "starts" else 0] = value
    object.__setattr__(owner, names[-1], array)
    with pytest.raises(ValueError, match=names[-1] if names[-1] != "starts" else "rows do not begin"):
        unpacked(packed(stored))


@settings(max_examples=30)
@given(st.randoms(use_true_random=False))
def test_any_damage_is_noticed_or_harmless(small, noise: random.Random):
    """Bytes that are changed anywhere lead to an error that is caught, never to something else."""
    data = bytearray(small)
    for _ in range(noise.randint(1, 4)):
        data[noise.randrange(len(data))] = noise.randrange(256)
    data = bytes(data[: noise.choice((len(data), noise.randrange(len(data))))])
    try:
        found = unpacked(data).found
    except (ValueError, TypeError, KeyError, RecursionError):
        return
    assert found.forward.faces.min() >= -1


@pytest.fixture(scope="module")
def small():
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    return packed(stored_between(ball("A", segments=5), ball("B", segments=4)))
