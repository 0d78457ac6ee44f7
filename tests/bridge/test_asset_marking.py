# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Morphs in the Asset Browser: what is marked, the picture, and a player that is appended elsewhere."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from convwass_addon.applications.morphs.layouts import grid_blends, path_blends
from convwass_addon.applications.morphs.morph_problem import MorphFrame
from convwass_addon.bridge.morphs.bake import MorphBake
from convwass_addon.bridge.morphs.pictures import asset_marking
from convwass_addon.bridge.morphs.pictures.asset_marking import mark_as_assets
from convwass_addon.bridge.morphs.players.blend_pad import make_blend_pad
from convwass_addon.bridge.morphs.players.player import make_player
from convwass_addon.bridge.morphs.players.player_inputs import morph_value
from convwass_addon.bridge.morphs.removal import remove_bake
from convwass_addon.bridge.morphs.stand_ins import remove_stand_ins
from convwass_addon.errors import InputError
from tests.moving_balls import bake


@pytest.fixture(autouse=True)
def small_pictures(monkeypatch):
    monkeypatch.setattr(asset_marking, "_SIDE", 32)
    monkeypatch.setattr(asset_marking, "_SAMPLES", 1)


@pytest.fixture
def collection(make_object, octahedron):
    """Bake an octahedron that rises from 0 to 4."""
    shapes = [make_object(name) for name in "AB"]
    shapes[1].location.z = 4.0
    for shape in shapes:
        shape.color = (1.0, 0.0, 0.0, 1.0)
    blends = path_blends(2, 4)
    made = MorphBake.begin(shapes, blends, {"resolution": 32}, 1)
    for blend in blends:
        mesh = None if blend.source is not None else octahedron.moved((0.0, 0.0, float(blend.frame)))
        made.add(MorphFrame(blend, mesh, {}))
    return made.finish(hide_inputs=True)


def height(shown):
    """The mean height in world space of what a player or a pad shows."""
    seen = shown.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return float(np.mean([(seen.matrix_world @ vertex.co).z for vertex in seen.to_mesh().vertices]))


def left_for_another(folder):
    """Save the file, open an empty one, and return the path of the saved one."""
    file = str(folder / "library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=file)
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    return file


def test_a_player_is_an_asset_that_plays_in_another_file(collection, tmp_path):
    player = make_player(collection)
    marked = mark_as_assets(collection)
    assert marked[:2] == [player, player.modifiers[0].node_group]
    for block in marked:
        assert block.asset_data.description == "A > B"
        assert [tag.name for tag in block.asset_data.tags] == ["morph"]
        picture = np.array(block.preview.image_pixels_float).reshape(*block.preview.image_size, 4)
        # The red shape on the white floor.
        (red, green, _, _), floor = picture[16, 16], picture[1, 1]
        assert red > green + 0.3
        assert floor[:3].min() > 0.8
    library = left_for_another(tmp_path)
    with bpy.data.libraries.load(library, assets_only=True) as (offered, taken):
        assert (len(offered.objects), len(offered.node_groups)) == (1, 1)
        taken.objects = offered.objects[:]
    (appended,) = taken.objects
    bpy.context.scene.collection.objects.link(appended)
    value = morph_value(appended)
    seen = []
    for moment in (0.25, 0.75):
        value.set(moment)
        appended.update_tag()
        bpy.context.view_layer.update()
        seen.append(height(appended))
    assert seen == pytest.approx([1.0, 3.0], abs=1e-3)


def test_a_pad_comes_with_the_collection_and_works_in_another_file(make_object, octahedron, tmp_path):
    def solved(weights):
        return octahedron.moved((0.0, 0.0, 16.0 * weights[0]))

    collection = bake(make_object, [octahedron] * 4, grid_blends(4, 3), solved)
    pad = make_blend_pad(collection)
    names = pad.handle.name, pad.result.name
    corner = tuple(pad.pad.data.vertices[4].co)
    assert mark_as_assets(collection) == [collection]
    library = left_for_another(tmp_path)
    with bpy.data.libraries.load(library, assets_only=True) as (offered, taken):
        taken.collections = offered.collections[:]
    bpy.context.scene.collection.children.link(taken.collections[0])
    handle, result = (bpy.data.objects[name] for name in names)
    handle.location = corner
    bpy.context.view_layer.update()
    assert height(result) == pytest.approx(4.0, abs=1e-3)


def test_without_a_player_the_collection_is_the_asset(collection):
    assert mark_as_assets(collection) == [collection]
    assert len(collection.asset_data.tags) == 1
    assert collection.preview.is_image_custom


def test_other_collections_are_refused(bare_scene):
    with pytest.raises(InputError, match="is not a morph"):
        mark_as_assets(bpy.data.collections.new("Other"))


def test_assets_of_the_user_keep_their_description(collection):
    player = make_player(collection)
    own = player.material_slots[0].material
    own.asset_mark()
    own.asset_data.description = "Gold"
    assert own not in mark_as_assets(collection)
    assert own.asset_data.description == "Gold"
    assert not own.asset_data.tags


@pytest.mark.parametrize("remove", [remove_stand_ins, remove_bake])
def test_marked_blocks_are_removed_with_the_player(collection, remove):
    player = make_player(collection)
    names = {(block.id_type, block.name) for block in mark_as_assets(collection)}
    assert {kind for kind, _ in names} == {"OBJECT", "NODETREE", "MATERIAL"}
    assert player.asset_data is not None
    remove(collection)
    assert not names & {(block.id_type, block.name) for block in bpy.data.user_map()}
