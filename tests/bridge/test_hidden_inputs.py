# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Hiding shapes of many parts."""

from __future__ import annotations

from types import SimpleNamespace

import bpy
import pytest

from convwass_addon.bridge import object_names, visibility
from convwass_addon.bridge.morphs.inputs import hidden_inputs
from convwass_addon.bridge.morphs.inputs.hidden_inputs import (
    copy_hidden,
    hidden_only_by,
    hide_shapes,
    instances_without,
    show_again,
)
from convwass_addon.bridge.morphs.stored import MORPH_KEY
from convwass_addon.bridge.visibility import is_in
from tests.searches import counted_searches

pytestmark = pytest.mark.usefixtures("empty_scene")


@pytest.fixture
def parts():
    """Six cubes."""
    for _ in range(6):
        bpy.ops.mesh.primitive_cube_add()
    return list(bpy.context.scene.objects)


def new_morph():
    morph = bpy.data.collections.new("Morph")
    bpy.context.scene.collection.children.link(morph)
    morph[MORPH_KEY] = "{}"
    return morph


def test_other_morphs_are_read_as_often_for_many_parts_as_for_one(parts, monkeypatch):
    other, morph = new_morph(), new_morph()
    hide_shapes(other, parts, bpy.context.scene)
    read, hidden_by = [], hidden_inputs._hidden_by
    monkeypatch.setattr(hidden_inputs, "_hidden_by", lambda own: read.append(own) or hidden_by(own))
    hide_shapes(morph, parts[:1], bpy.context.scene)
    for_one = read.copy()
    hide_shapes(morph, parts, bpy.context.scene)
    assert for_one
    assert read == 2 * for_one


def test_parts_that_two_morphs_hide_are_hidden_only_by_neither(parts):
    first, second = new_morph(), new_morph()
    hide_shapes(first, parts[:4], bpy.context.scene)
    hide_shapes(second, parts[2:], bpy.context.scene)
    for morph, own in ((first, parts[:2]), (second, parts[4:])):
        names = [one.name.name for one in hidden_only_by(morph) if one.in_renders and one.layers]
        assert names == [obj.name for obj in own]


@pytest.fixture
def second_scene(parts):
    """A scene with the same parts, and a view layer of the same name."""
    scene = bpy.data.scenes.new("Second")
    for part in parts:
        scene.collection.objects.link(part)
    scene.view_layers[0].update()
    assert scene.view_layers[0].name == bpy.context.view_layer.name
    return scene


def hidden_in(scene, parts):
    return [part.hide_get(view_layer=scene.view_layers[0]) for part in parts]


def test_what_is_hidden_in_another_scene_stays_hidden(parts, second_scene):
    parts[0].hide_set(True, view_layer=second_scene.view_layers[0])
    morph = new_morph()
    hide_shapes(morph, parts[:2], bpy.context.scene)
    parts[1].hide_set(True, view_layer=second_scene.view_layers[0])
    show_again(hidden_only_by(morph))
    assert hidden_in(bpy.context.scene, parts[:2]) == [False, False]
    assert hidden_in(second_scene, parts[:2]) == [True, True]


def test_what_was_hidden_but_in_another_scene_stays_hidden(parts, second_scene):
    parts[0].hide_set(True)
    morph = new_morph()
    hide_shapes(morph, parts[:2], bpy.context.scene)
    show_again(hidden_only_by(morph))
    assert hidden_in(bpy.context.scene, parts[:2]) == [True, False]


def test_parts_are_shown_again_after_the_scene_was_renamed(parts):
    morph = new_morph()
    hide_shapes(morph, parts[:2], bpy.context.scene)
    bpy.context.scene.name = "Shot 010"
    show_again(hidden_only_by(morph))
    assert hidden_in(bpy.context.scene, parts[:2]) == [False, False]


@pytest.mark.parametrize("renamed_scene", [False, True])
def test_parts_are_shown_again_after_the_view_layer_was_renamed(parts, second_scene, renamed_scene):
    morph = new_morph()
    hide_shapes(morph, parts, bpy.context.scene)
    bpy.context.view_layer.name = "Beauty"
    if renamed_scene:
        bpy.context.scene.name = "Shot 10"
    show_again(hidden_only_by(morph))
    assert not any(part.hide_get() for part in parts)


def test_parts_that_another_morph_hides_stay_hidden_after_the_scene_was_renamed(parts):
    first, second = new_morph(), new_morph()
    hide_shapes(first, parts[:2], bpy.context.scene)
    bpy.context.scene.name = "Shot 010"
    hide_shapes(second, parts[:2], bpy.context.scene)
    show_again(hidden_only_by(first))
    assert hidden_in(bpy.context.scene, parts[:2]) == [True, True]


def test_the_shapes_of_a_linked_morph_are_other_ones(parts, tmp_path):
    """Although they have the same names."""
    morph = new_morph()
    hide_shapes(morph, parts[:2], bpy.context.scene)
    bpy.data.libraries.write(str(tmp_path / "library.blend"), {morph})
    bpy.data.collections.remove(morph)
    with bpy.data.libraries.load(str(tmp_path / "library.blend"), link=True) as (_, wanted):
        wanted.collections = ["Morph"]
    sampled = new_morph()
    copy_hidden(wanted.collections[0], sampled)
    show_again(hidden_only_by(sampled))
    assert hidden_in(bpy.context.scene, parts[:2]) == [True, True]


def instance(name, collection):
    """Add an Empty that instances a collection."""
    empty = bpy.data.objects.new(name, None)
    empty.instance_type, empty.instance_collection = "COLLECTION", collection
    bpy.context.scene.collection.objects.link(empty)
    return empty


def test_instances_that_lack_hidden_parts_are_named(parts):
    figure, crowd, others = (bpy.data.collections.new(name) for name in ("Figure", "Crowd", "Others"))
    limbs = bpy.data.collections.new("Limbs")
    figure.children.link(limbs)
    limbs.objects.link(parts[0])
    others.objects.link(parts[1])
    crowd.objects.link(instance("Member", figure))
    for name, collection in (("Near", figure), ("Rows", crowd), ("Others", others)):
        instance(name, collection)
    instance("Unseen", figure).hide_render = True
    morph = new_morph()
    hide_shapes(morph, parts[2:4], bpy.context.scene)
    assert instances_without(morph) == ([], [])
    hide_shapes(morph, [parts[0], parts[2]], bpy.context.scene)
    assert instances_without(morph) == (["Member", "Near", "Rows"], [parts[0].name])
    hide_shapes(morph, [], bpy.context.scene)
    assert instances_without(morph) == ([], [])


def test_instances_of_a_collection_are_looked_at_together(parts, monkeypatch):
    figure = bpy.data.collections.new("Figure")
    figure.objects.link(parts[0])
    names = sorted(instance(f"Near {place}", figure).name for place in range(4))
    bpy.data.objects.remove(instance("Deleted", figure))
    bpy.context.scene.collection.objects.unlink(instance("Unlinked", figure))
    bpy.data.objects["Unlinked"].use_fake_user = True
    morph = new_morph()
    hide_shapes(morph, parts[:1], bpy.context.scene)
    monkeypatch.setattr(hidden_inputs, "_lost_in_renders", lambda _: parts[:1])
    shown, looked_at = hidden_inputs._instanced, []
    monkeypatch.setattr(hidden_inputs, "_instanced", lambda own: looked_at.append(own) or shown(own))
    searches = counted_searches(monkeypatch, hidden_inputs, visibility)
    assert instances_without(morph) == (names, [parts[0].name])
    assert looked_at == [figure]
    assert searches == {"objects": 1, "scenes": 1}


def test_objects_of_several_names_are_found_in_one_search(parts, monkeypatch):
    names = [object_names.ObjectName.of(part) for part in parts]
    parts[1].use_fake_user = True
    bpy.context.scene.collection.objects.unlink(parts[1])
    searches = counted_searches(monkeypatch, object_names, visibility)
    assert object_names.objects_named(names) == [parts[0], None, *parts[2:]]
    assert searches == {"objects": 1, "scenes": 1}


def test_an_instance_that_is_a_shape_itself_is_not_named(parts):
    figure = bpy.data.collections.new("Figure")
    figure.objects.link(parts[0])
    morph = new_morph()
    hide_shapes(morph, [parts[0], instance("Near", figure)], bpy.context.scene)
    assert instances_without(morph) == ([], [])


def test_a_view_layer_is_not_listed_to_find_an_object(parts):
    class Unlisted(dict):
        def __iter__(self):
            raise AssertionError("lists all objects")

    layer = SimpleNamespace(objects=Unlisted({obj.name: obj for obj in parts[1:]}))
    assert is_in(layer, parts[1])
    assert not is_in(layer, parts[0])
