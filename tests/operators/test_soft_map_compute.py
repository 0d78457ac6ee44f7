# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Computing soft maps: arguments, storage, and later use."""

from __future__ import annotations

import time
from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from convwass_addon.applications.soft_maps import map_solving, mirror_maps
from convwass_addon.applications.soft_maps.soft_map_settings import SoftMapSettings
from convwass_addon.bridge.soft_maps.soft_map_bytes import StoredSoftMap
from convwass_addon.bridge.soft_maps.soft_map_store import MAPS_KEY, has_soft_map, store_soft_map, stored_soft_map
from convwass_addon.bridge.vertex_groups import read_group, write_group
from convwass_addon.errors import InputError
from convwass_addon.operators.soft_map_compute import CONVWASS_OT_compute_soft_map
from convwass_addon.progress import UNINTERRUPTED, Progress
from convwass_addon.sentence import Sentence
from tests.linked_objects import linked_to_new_file
from tests.operators.running import ESCAPE, Pressed, call, pretend_window, until, window_context
from tests.operators.soft_maps import choose, own, points, select, sphere, store_closest, store_mirror
from tests.surface_maps import closest_map

pytestmark = pytest.mark.usefixtures("empty_scene")


@pytest.fixture
def pair():
    objects = sphere("Cow"), sphere("Horse", segments=24, ring_count=12)
    choose(*objects)
    return objects


@pytest.fixture
def asked(monkeypatch):
    """Replace the solver by the closest-point map; yields the solver's arguments."""
    calls = []

    def steps(source, target, pairs, settings, control=UNINTERRUPTED):
        calls.append(SimpleNamespace(source=source, target=target, pairs=pairs.tolist(), settings=settings))
        yield Progress(0.5, Sentence("Solving the map"))
        return closest_map(source.mesh, target.mesh)

    monkeypatch.setattr(map_solving, "soft_map_steps", steps)
    monkeypatch.setattr(
        mirror_maps,
        "mirror_map_steps",
        lambda side, pairs, settings, control: steps(side, side, pairs, settings, control),
    )
    return calls


def test_the_list_of_pairs_and_the_settings_are_handed_over(pair, asked, capfd):
    for vertices in ((3, 4), (5, 6), (7, 8)):
        call("add_map_pair", source_vertex=vertices[0], target_vertex=vertices[1])
    own().pairs[1].enabled = False
    half = own().pairs.add()
    half.source_vertex = 9
    pair[0].location.x = 3
    bpy.context.view_layer.update()
    assert call("compute_soft_map", vertices=500, tau=20, sweeps=5, symmetric=True) == {"FINISHED"}
    (request,) = asked
    assert request.pairs == [[3, 4], [7, 8]]
    assert request.settings == SoftMapSettings(vertices=500, tau=20, sweeps=5, symmetric=True)
    assert (request.source.name, request.target.name) == ("Cow", "Horse")
    np.testing.assert_allclose(request.source.mesh.vertices, points(pair[0]) + np.array((3, 0, 0)), atol=1e-5)
    assert request.source.groups == {}
    assert len(stored_soft_map(*pair).found.forward) == len(pair[0].data.vertices)
    assert (
        "Soft map from Cow to Horse: 2 pairs, 0% of the vertices are doubtful. This is a test" in capfd.readouterr().out
    )


def test_defaults_are_those_of_the_application(pair, asked):
    call("compute_soft_map", pairs="1:2, 3:4")
    assert asked[0].settings == SoftMapSettings()
    assert asked[0].pairs == [[1, 2], [3, 4]]


def test_without_pairs_the_application_decides(pair, asked):
    call("compute_soft_map")
    assert asked[0].pairs == []


def test_painted_groups_take_part_where_wanted(pair, asked):
    for obj in pair:
        write_group(obj, "Ear", np.linspace(0, 1, len(obj.data.vertices)))
    write_group(pair[0], "Horn", np.ones(len(pair[0].data.vertices)))
    call("compute_soft_map", use_groups=True)
    assert asked[0].source.groups.keys() == asked[0].target.groups.keys() == {"Ear"}
    np.testing.assert_allclose(asked[0].target.groups["Ear"], read_group(pair[1], "Ear"))


@pytest.mark.parametrize("text", ["12", "a:b", "1:2:3", "1:2 3", "1-2"])
def test_other_texts_are_no_pairs(pair, asked, text):
    with pytest.raises(RuntimeError, match="Pairs must be two vertex numbers with a colon, such as 12:40"):
        call("compute_soft_map", pairs=text)
    assert not has_soft_map(*pair)


def test_a_pair_that_has_lost_its_vertex_is_named(pair, asked):
    call("add_map_pair", source_vertex=3, target_vertex=4)
    own().pairs[0].target_vertex = 5000
    with pytest.raises(RuntimeError, match="Pair 1 refers to vertex 5000, but Horse has 266 vertices; remove the pair"):
        call("compute_soft_map")


def test_modifiers_that_add_vertices_are_reported(pair, asked, capfd):
    pair[0].modifiers.new("Subdivision", "SUBSURF")
    call("compute_soft_map")
    assert "Modifiers that change the vertices are ignored: Subdivision" in capfd.readouterr().out


def test_an_error_of_the_application_leaves_the_map_that_was_there(pair, asked, monkeypatch):
    call("compute_soft_map")
    before = bytes(pair[0][MAPS_KEY]["0"]["data"])

    def refuse(*_arguments):
        yield Progress(0.0, Sentence("Reading the meshes"))
        raise InputError("No piece of {source} fits.", source="Cow")

    monkeypatch.setattr(map_solving, "soft_map_steps", refuse)
    with pytest.raises(RuntimeError, match="No piece of Cow fits"):
        call("compute_soft_map")
    assert pair[0][MAPS_KEY]["0"]["data"] == before


def test_linked_objects_hold_no_map(pair, asked, tmp_path):
    cow = linked_to_new_file("Cow", tmp_path)
    horse = sphere("Horse", segments=24, ring_count=12)
    choose(cow, horse)
    with pytest.raises(RuntimeError, match=r"Cow is linked from another file, or .* transfer from Target to Source"):
        call("compute_soft_map")
    choose(cow, cow)
    with pytest.raises(RuntimeError, match="Cow is linked from another file and cannot be changed here"):
        call("mirror_map")
    choose(horse, cow)
    assert call("compute_soft_map") == {"FINISHED"}
    with pytest.raises(RuntimeError, match="Cow is linked from another file"):
        call("transfer_by_map", what={"UVS"})
    assert call("transfer_by_map", what={"UVS"}, direction="BACKWARD") == {"FINISHED"}


def test_library_overrides_hold_no_map(pair, asked, tmp_path):
    """Blender does not save it."""
    cow = linked_to_new_file("Cow", tmp_path).override_create(remap_local_usages=True)
    horse = sphere("Horse", segments=24, ring_count=12)
    choose(cow, horse)
    with pytest.raises(
        RuntimeError, match=r"Cow is .* overrides an object of one, and .* transfer from Target to Source"
    ):
        call("compute_soft_map")
    choose(cow, cow)
    with pytest.raises(RuntimeError, match="Cow is a library override, which loses its soft maps"):
        call("mirror_map")
    assert MAPS_KEY not in cow


def test_a_mirror_map_has_its_own_button(pair, asked):
    with pytest.raises(RuntimeError, match="Choose the same object as source and target"):
        call("mirror_map")
    choose(pair[0], pair[0])
    with pytest.raises(RuntimeError, match="Choose two objects, or press Mirror Map for one"):
        call("compute_soft_map")
    assert call("mirror_map", pairs="3:4") == {"FINISHED"}
    assert asked[0].pairs == [[3, 4]]
    assert has_soft_map(pair[0], pair[0])


def test_removing(pair, asked):
    with pytest.raises(RuntimeError, match="Compute the soft map first"):
        call("remove_soft_map")
    call("compute_soft_map")
    bpy.ops.ed.undo_push(message="there")
    assert call("remove_soft_map") == {"FINISHED"}
    assert MAPS_KEY not in pair[0]
    bpy.ops.ed.undo_push(message="gone")
    bpy.ops.ed.undo()
    assert has_soft_map(bpy.data.objects["Cow"], bpy.data.objects["Horse"])


def test_doubtful_points_are_filled_in(pair, capfd):
    store_closest(*pair)
    stored = stored_soft_map(*pair)
    forward = stored.found.forward
    confidence, faces = forward.confidence.copy(), forward.faces.copy()
    doubtful = np.flatnonzero(np.linalg.norm(points(pair[0]) - (1, 0, 0), axis=1) < 0.4)
    confidence[doubtful], faces[doubtful] = 0.1, 0
    wrong = type(forward)(faces, forward.barycentric, forward.spread, forward.entropy, confidence)
    found = type(stored.found)(wrong, stored.found.backward, stored.found.coarse)
    store_soft_map(*pair, StoredSoftMap(found, stored.source, stored.target))
    assert call("repair_soft_map", threshold=0.3) == {"FINISHED"}
    assert f"Filled in {len(doubtful)} points from Cow and 0 from Horse" in capfd.readouterr().out
    repaired = stored_soft_map(*pair)
    corners = points(pair[1])[repaired.target.triangles[repaired.found.forward.faces]]
    places = np.einsum("nk,nkd->nd", repaired.found.forward.barycentric, corners)
    assert np.linalg.norm(places - points(pair[0]), axis=1)[doubtful].max() < 0.1


def test_repairing_needs_something_to_go_by(pair):
    store_closest(*pair)
    with pytest.raises(RuntimeError, match="No point of the map is confident enough"):
        call("repair_soft_map", threshold=1.0)


def colors(obj, name):
    return np.array([item.color for item in obj.data.color_attributes[name].data])


@pytest.mark.parametrize("mode", ["OBJECT", "EDIT"])
def test_corresponding_points_have_the_same_color(pair, mode):
    store_closest(*pair)
    bpy.ops.object.mode_set(mode=mode)
    assert call("show_soft_map") == {"FINISHED"}
    assert pair[1].mode == mode
    bpy.ops.object.mode_set(mode="OBJECT")
    for obj in pair:
        np.testing.assert_allclose(colors(obj, "Soft Map")[:, :3], (points(obj) + 1) / 2, atol=0.03)
        assert obj.data.color_attributes.active_color_name == "Soft Map"


def test_the_distribution_of_a_vertex(pair, capfd):
    store_closest(*pair)
    top = int(points(pair[0])[:, 2].argmax())
    select(pair[0], top)
    assert call("show_distribution") == {"FINISHED"}
    assert f"Vertex {top} of Cow goes to Horse, with a spread of 0.25" in capfd.readouterr().out
    bright = colors(pair[1], "Soft Map Distribution").sum(axis=1)
    assert bright.argmax() == points(pair[1])[:, 2].argmax()
    assert colors(pair[0], "Soft Map Distribution").sum(axis=1).argmax() == top
    call("show_distribution", vertex=0)
    with pytest.raises(RuntimeError, match="There is no vertex 9999"):
        call("show_distribution", vertex=9999)
    select(pair[0], 1, 2)
    with pytest.raises(RuntimeError, match="Select one vertex of Cow in Edit Mode; 2 are selected now"):
        call("show_distribution")


def test_a_vertex_without_an_image(pair):
    pair[0].data.vertices.add(1)
    store_closest(*pair)
    stored = stored_soft_map(*pair)
    rows = stored.found.coarse
    shares = rows.source.shares.copy()
    shares[-1] = 0.0
    rows = type(rows)(
        rows.starts, rows.columns, rows.values, type(rows.source)(rows.source.columns, shares), rows.target
    )
    found = type(stored.found)(stored.found.forward, stored.found.backward, rows)
    store_soft_map(*pair, StoredSoftMap(found, stored.source, stored.target))
    with pytest.raises(RuntimeError, match="Vertex 482 of Cow has no image on the other surface"):
        call("show_distribution", vertex=482)
    assert "Soft Map Distribution" not in pair[1].data.color_attributes


def test_names_that_are_taken_are_refused_before_anything_is_written(pair):
    store_closest(*pair)
    pair[1].vertex_groups.new(name="Soft Map")
    with pytest.raises(RuntimeError, match="Horse has an attribute or vertex group Soft Map of another kind"):
        call("show_soft_map")
    assert "Soft Map" not in pair[0].data.color_attributes


def test_confidence_becomes_a_group_of_both(pair):
    store_closest(*pair)
    assert call("map_confidence") == {"FINISHED"}
    for obj in pair:
        np.testing.assert_allclose(read_group(obj, "Soft Map Confidence"), 0.75)
        assert obj.vertex_groups.active.name == "Soft Map Confidence"
    pair[1].vertex_groups["Soft Map Confidence"].lock_weight = True
    pair[0].vertex_groups.clear()
    with pytest.raises(RuntimeError, match="The group Soft Map Confidence is locked"):
        call("map_confidence")
    assert not pair[0].vertex_groups


def test_a_mirror_map_is_looked_at_too():
    obj = sphere("Cow")
    store_mirror(obj)
    for name in ("show_soft_map", "map_confidence"):
        assert call(name) == {"FINISHED"}
    assert call("show_distribution", vertex=5) == {"FINISHED"}
    images = colors(obj, "Soft Map")[:, :3]
    np.testing.assert_allclose(images, (points(obj) * (-1, 1, 1) + 1) / 2, atol=0.03)


NAMES = ("compute_soft_map", "repair_soft_map", "remove_soft_map", "show_soft_map", "map_confidence", "mirror_map")


@pytest.mark.parametrize("name", NAMES)
def test_missing_input_is_reported(name):
    with pytest.raises(RuntimeError, match="Choose a source and a target"):
        call(name)


def start(monkeypatch, **arguments):
    context, pressed = window_context(), Pressed(CONVWASS_OT_compute_soft_map, **arguments)
    pretend_window(monkeypatch)
    assert pressed.invoke(context, None) == {"RUNNING_MODAL"}
    return pressed, context


def test_it_runs_in_the_background(pair, asked, monkeypatch):
    pressed, context = start(monkeypatch, pairs="1:2")
    assert until(pressed, context) == {"FINISHED"}
    assert has_soft_map(*pair)


def test_escape_leaves_no_map(pair, monkeypatch):
    def for_ever(source, target, pairs, settings, control):
        while True:
            yield Progress(0.5, Sentence("Solving the map"))
            time.sleep(0.001)
            control.check()

    monkeypatch.setattr(map_solving, "soft_map_steps", for_ever)
    pressed, context = start(monkeypatch)
    assert pressed.modal(context, ESCAPE) == {"CANCELLED"}
    assert pressed.reports[-1] == ("INFO", "Stopped; nothing was changed")
    assert not has_soft_map(*pair)


def test_meshes_that_change_meanwhile_get_no_map(pair, asked, monkeypatch):
    pressed, context = start(monkeypatch)
    pair[1].data.vertices.add(1)
    assert until(pressed, context) == {"CANCELLED"}
    assert "The vertices of Horse have changed since the start" in pressed.reports[-1][1]
    assert not has_soft_map(*pair)
    pressed, context = start(monkeypatch)
    bpy.data.objects.remove(pair[1])
    assert until(pressed, context) == {"CANCELLED"}
    assert "An object was deleted, or its creation undone" in pressed.reports[-1][1]
