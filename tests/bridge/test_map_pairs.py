# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pairs of vertices from names: of vertex groups and of Empties."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from convwass_addon.bridge.soft_maps.map_pairs import MapPair, pairs_from_empties, pairs_from_groups
from convwass_addon.errors import InputError


def ball(name, location=(0, 0, 0)):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=16, ring_count=8, location=location)
    bpy.context.object.name = name
    return bpy.context.object


@pytest.fixture
def pair():
    return ball("Cow"), ball("Horse", (5, 0, 0))


def mark(obj, name, *vertices, weight=1.0):
    group = obj.vertex_groups.new(name=name)
    group.add(list(vertices), weight, "REPLACE")


def empty(name, location, parent=None):
    obj = bpy.data.objects.new(name, None)
    bpy.context.scene.collection.objects.link(obj)
    obj.parent = parent
    obj.location = location
    return obj


def vertex_at(obj, direction):
    """The vertex of a sphere that is farthest in a direction."""
    points = np.array([vertex.co for vertex in obj.data.vertices])
    return int((points @ direction).argmax())


def groups(pair, **arguments):
    return pairs_from_groups(*pair, bpy.context.evaluated_depsgraph_get(), **arguments)


def empties(pair):
    return pairs_from_empties(*pair, bpy.context.evaluated_depsgraph_get(), bpy.context.scene.objects)


def test_groups_of_one_vertex(pair):
    for obj, vertices in zip(pair, ((3, 7), (4, 9)), strict=True):
        for name, vertex in zip(("nose", "tail"), vertices, strict=True):
            mark(obj, name, vertex)
    mark(pair[0], "only here", 5)
    found = groups(pair)
    assert found.pairs == (MapPair("nose", 3, 4), MapPair("tail", 7, 9))
    assert groups(pair, pattern="n*").pairs == found.pairs[:1]


def test_the_middle_of_a_group_counts(pair):
    """A vertex with all its neighbors: the middle one, though others weigh as much."""
    for obj in pair:
        x = vertex_at(obj, (1, 0, 0))
        near = [v.index for v in obj.data.vertices if (v.co - obj.data.vertices[x].co).length < 0.5]
        assert len(near) == 5
        mark(obj, "cheek", *near)
    (found,) = groups(pair, largest=0.1).pairs
    assert (found.source, found.target) == tuple(vertex_at(obj, (1, 0, 0)) for obj in pair)


def test_large_and_empty_groups_are_no_marks(pair):
    for obj in pair:
        mark(obj, "bone", *range(40))
        mark(obj, "empty", 3, weight=0.0)
    found = groups(pair)
    assert (found.pairs, set(found.left_out)) == ((), {"bone", "empty"})
    assert [own.name for own in groups(pair, largest=1.0).pairs] == ["bone"]
    assert groups(pair, pattern="nothing").pairs == ()


def test_groups_of_one_object_are_paired_across():
    obj = ball("Cow")
    for name, vertex in (("Hand.R", 3), ("Hand.L", 7), ("nose", 9), ("Foot.L", 11)):
        mark(obj, name, vertex)
    assert groups((obj, obj)).pairs == (MapPair("Hand.L", 7, 3),)


def test_empties_belong_to_the_nearer_object(pair):
    for place, obj in enumerate(pair):
        for name, direction in (("nose", (1, 0, 0)), ("top", (0, 0, 1))):
            empty(f"{name}.{place:03d}", np.array(obj.location) + 1.2 * np.array(direction))
    empty("lone", (0, 1, 0))
    empty("twice", (0, -1, 0))
    empty("twice.001", (0, -1.1, 0))
    empty("twice.002", (5, -1, 0))
    found = empties(pair)
    assert {own.name: (own.source, own.target) for own in found.pairs} == {
        name: tuple(vertex_at(obj, direction) for obj in pair)
        for name, direction in (("nose", (1, 0, 0)), ("top", (0, 0, 1)))
    }
    assert set(found.left_out) == {"lone", "twice"}


def test_parents_decide_before_distance(pair):
    """Both stand at the cow; one is the horse's, by way of another Empty, whose place is not its own."""
    between = empty("between", (0, 0, 0), parent=pair[1])
    empty("nose", (1.2, 0, 0))
    empty("nose.001", (-4, 0, 0), parent=between)
    (found,) = empties(pair).pairs
    assert found == MapPair("nose", vertex_at(pair[0], (1, 0, 0)), vertex_at(pair[1], (-1, 0, 0)))


def test_empties_of_one_object_are_paired_across():
    obj = ball("Cow")
    empty("Ear.L", (1, 0, 0))
    empty("Ear.R", (-1, 0, 0))
    empty("nose", (0, 0, 1))
    found = empties((obj, obj))
    assert found.pairs == (MapPair("Ear.L", vertex_at(obj, (1, 0, 0)), vertex_at(obj, (-1, 0, 0))),)


def test_modifiers_and_loose_vertices_are_heeded(pair):
    """The horse is seen where a modifier puts it; a vertex without faces is none of the surface."""
    pair[1].modifiers.new("Displace", "DISPLACE").direction = "X"
    front = vertex_at(pair[1], (1, 0, 0))
    pair[1].data.vertices.add(1)
    pair[1].data.vertices[-1].co = (1.2, 0, 0)
    empty("nose", (1.2, 0, 0))
    empty("nose.001", (6.5, 0, 0))
    (found,) = empties(pair).pairs
    assert found.target == front


@pytest.mark.parametrize("far", [1e30, 3e38])
def test_objects_beyond_all_measure_have_pairs_too(pair, far):
    """Blender's coordinates are single precision, in which squares and products of large ones overflow."""
    pair[1].location, pair[1].scale = (far, 0, 0), (-far / 10, far / 10, far / 10)
    for obj, name in zip(pair, ("nose", "nose.001"), strict=True):
        empty(name, obj.location)
    assert [own.name for own in empties(pair).pairs] == ["nose"]


def test_objects_without_a_surface_are_refused(pair):
    bpy.data.objects["Horse"].data.clear_geometry()
    with pytest.raises(InputError, match="Horse has no faces"):
        empties(pair)
