# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What is stored with shape keys to bake them again."""

from __future__ import annotations

import bpy
import pytest

from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.bridge.morphs.morph_request import MorphRequest
from convwass_addon.bridge.morphs.stored import store
from convwass_addon.bridge.morphs.stored_parts import stored_parts
from convwass_addon.bridge.one_mesh.records import RECORD_KEY, described_bake, slider_names

pytestmark = pytest.mark.usefixtures("empty_scene")


@pytest.mark.parametrize("grouping", ["PARENTS", "COLLECTIONS"])
def test_shapes_are_the_objects_alone(grouping):
    home = bpy.data.collections.new("Home")
    bpy.context.scene.collection.children.link(home)
    objects = [bpy.data.objects.new(name, bpy.data.meshes.new(name)) for name in ("A", "B", "Part")]
    for obj in objects:
        home.objects.link(obj)
    *inputs, part = objects
    part.parent = inputs[1]
    keyed = bpy.data.objects.new("Keyed", bpy.data.meshes.new("Keyed"))
    store(keyed, described_bake(inputs, MorphRequest(grouping=grouping), MorphSettings(), 1))
    assert stored_parts(keyed) == inputs


@pytest.mark.parametrize("text", ["", "[1]", '[{"name": "A"}]', "[" * 100_000])
def test_damaged_records_are_none(text):
    obj = bpy.data.objects.new("Keyed", bpy.data.meshes.new("Keyed"))
    obj[RECORD_KEY] = text
    assert slider_names(obj) == []
