# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The command ``softmap``: files, output and exit codes."""

from __future__ import annotations

import json

import bpy
import numpy as np
import pytest

from convwass_addon import cli
from convwass_addon.bridge.element_values import element_values
from convwass_addon.bridge.soft_maps.soft_map_store import stored_soft_map
from convwass_addon.bridge.vertex_groups import read_group

pytestmark = [
    pytest.mark.usefixtures("empty_scene"),
    # Blender's own exporters under NumPy 2.5.
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
]

QUICK = ("--vertices", "200", "--sweeps", "4")


def points_of(mesh):
    return element_values(mesh.vertices, "co", 3).astype(float)


def vertices_near(obj, places):
    points = points_of(obj.data)
    return [int(np.linalg.norm(points - place, axis=1).argmin()) for place in places]


def add_blob(name, subdivisions, location):
    """Add and return a ball with UVs and three different axes."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=subdivisions, location=location)
    obj = bpy.context.object
    obj.name = obj.data.name = name
    points = points_of(obj.data) * [1.0, 0.7, 1.6]
    points[:, 0] += 0.3 * points[:, 2] ** 2
    obj.data.vertices.foreach_set("co", points.astype(np.float32).ravel())
    obj.data.update()
    return obj


PLACES = [(0.77, 0, 1.6), (0.77, 0, -1.6), (-1, 0, 0), (1, 0, 0), (0, 0.7, 0), (0, -0.7, 0)]


@pytest.fixture
def files(tmp_path, empty_scene):
    """Two blobs, one finer; the first has weights, a shape key and colors. Their pairs, also as weak marks."""
    folder = tmp_path / "in"
    folder.mkdir()
    fox, dog = add_blob("Fox", 4, (0, 0, 0)), add_blob("Dog", 5, (5, 0, 0))
    points = points_of(fox.data)
    for name, sign in (("Top", 1), ("Bottom", -1)):
        group = fox.vertex_groups.new(name=name)
        for vertex, z in enumerate(points[:, 2]):
            group.add([vertex], 0.5 + sign * z / 3.2, "REPLACE")
    fox.shape_key_add(name="Basis")
    key = fox.shape_key_add(name="Tall", from_mix=False)
    tall = points + np.clip(points[:, 2:], 0, None) * [0, 0, 0.5]
    key.data.foreach_set("co", tall.astype(np.float32).ravel())
    colors = fox.data.color_attributes.new("Fur", "FLOAT_COLOR", "POINT")
    rgba = np.column_stack([points / 3.2 + 0.5, np.ones(len(points))])
    colors.data.foreach_set("color", rgba.astype(np.float32).ravel())
    pairs = list(zip(vertices_near(fox, PLACES), vertices_near(dog, PLACES), strict=True))
    for place, (a, b) in enumerate(pairs):
        for obj, vertex in ((fox, a), (dog, b)):
            obj.vertex_groups.new(name=f"mark {place}").add([vertex], 5e-4, "REPLACE")
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "pets.blend"))
    bpy.ops.object.select_all(action="DESELECT")
    for name, obj in (("fox", fox), ("dog", dog)):
        obj.select_set(True)
        bpy.ops.wm.obj_export(filepath=str(folder / f"{name}.obj"), export_selected_objects=True)
        obj.select_set(False)
    return folder, [f"{a}:{b}" for a, b in pairs]


def run(capfd, *words):
    """Run the command; return its exit code, standard output and standard error."""
    capfd.readouterr()
    code = cli.main(["softmap", *map(str, words)])
    return code, *capfd.readouterr()


def test_weights_keys_uvs_and_colors_are_transferred_in_the_users_scene(files, tmp_path, capfd):
    folder, pairs = files
    out, report = tmp_path / "dog.blend", tmp_path / "map.json"
    blend = folder / "pets.blend"
    words = [f"{blend}:Fox", f"{blend}:Dog", "--pairs", *pairs, "--transfer", "weights", "keys", "uvs", "colors"]
    code, printed, said = run(
        capfd, *words, "--names", "Top", "Bottom", "Tall", "UVMap", "Fur", *QUICK, "--out", out, "--report", report
    )
    assert code == 0, said
    assert printed.split() == [str(out), str(report)]
    record = json.loads(report.read_text())
    assert (record["source"], record["target"]) == ("Fox", "Dog")
    assert record["pairs"] == [[int(n) for n in pair.split(":")] for pair in pairs]
    assert record["transferred"] == {
        "weights": ["Top", "Bottom"],
        "keys": ["Tall"],
        "uvs": ["UVMap"],
        "colors": ["Fur"],
    }
    assert record["forward"]["without_point"] == 0 and record["forward"]["median_confidence"] > 0.5
    bpy.ops.wm.open_mainfile(filepath=str(out))
    fox, dog = bpy.data.objects["Fox"], bpy.data.objects["Dog"]
    points = points_of(dog.data)
    top, bottom = read_group(dog, "Top"), read_group(dog, "Bottom")
    assert np.abs(top - (0.5 + points[:, 2] / 3.2)).mean() < 0.03
    np.testing.assert_allclose(top + bottom, 1.0, atol=1e-3)
    key = dog.data.shape_keys.key_blocks["Tall"]
    moved = np.empty(points.size, np.float32)
    key.data.foreach_get("co", moved)
    expected = np.clip(points[:, 2:], 0, None) * [0, 0, 0.5]
    assert np.linalg.norm(moved.reshape(-1, 3) - points - expected) < 0.3 * np.linalg.norm(expected)
    colors = element_values(dog.data.color_attributes["Fur"].data, "color", 4)
    assert np.abs(colors[:, :3] - (points / 3.2 + 0.5)).mean() < 0.03
    assert "UVMap" in dog.data.uv_layers
    stored = stored_soft_map(fox, dog)
    assert len(stored.found.forward) == len(fox.data.vertices)


def test_pairs_come_from_groups_too_and_the_inverse_map_is_written(files, tmp_path, capfd):
    folder, _ = files
    blend = folder / "pets.blend"
    words = [f"{blend}:Dog", f"{blend}:Fox", "--pairs-from", "groups", "--transfer", "weights", "--names", "Top"]
    code, printed, said = run(capfd, *words, "--reverse", *QUICK, "--out", tmp_path / "back", "--json")
    assert code == 0, said
    record = json.loads(printed)
    assert len(record["pairs"]) == 6
    assert record["written"] == [str(tmp_path / "back.blend")]
    assert record["transferred"] == {"weights": ["Top"]}
    bpy.ops.wm.open_mainfile(filepath=record["written"][0])
    dog = bpy.data.objects["Dog"]
    assert read_group(dog, "Top").max() > 0.9


def test_plain_files_are_read_into_one_scene_and_doubtful_points_are_interpolated(files, tmp_path, capfd):
    folder, pairs = files
    out = tmp_path / "both.blend"
    words = [folder / "fox.obj", folder / "dog.obj", "--pairs", *pairs, "--transfer", "uvs", "--repair", "0.5"]
    code, _, said = run(capfd, *words, *QUICK, "--symmetric", "--out", out)
    assert code == 0, said
    assert "were filled in from their neighbors" in said
    bpy.ops.wm.open_mainfile(filepath=str(out))
    assert sorted(obj.name for obj in bpy.data.objects) == ["dog", "fox"]


def test_an_object_of_another_blend_keeps_its_keys(files, tmp_path, capfd):
    folder, _ = files
    bpy.ops.wm.open_mainfile(filepath=str(folder / "pets.blend"))
    bpy.data.objects.remove(bpy.data.objects["Fox"])
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "dogs.blend"))
    out = tmp_path / "out.blend"
    words = [f"{folder / 'dogs.blend'}:Dog", f"{folder / 'pets.blend'}:Fox", "--pairs-from", "groups", "--reverse"]
    code, _, said = run(capfd, *words, "--transfer", "keys", *QUICK, "--out", out)
    assert code == 0, said
    bpy.ops.wm.open_mainfile(filepath=str(out))
    assert "Tall" in bpy.data.objects["Dog"].data.shape_keys.key_blocks


def test_left_is_mirrored_to_the_right(files, tmp_path, capfd):
    folder, _ = files
    bpy.ops.wm.open_mainfile(filepath=str(folder / "pets.blend"))
    dog = bpy.data.objects["Dog"]
    points = points_of(dog.data)
    dog.vertex_groups.new(name="Ear.L").add(np.flatnonzero(points[:, 1] > 0.5).tolist(), 1.0, "REPLACE")
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "ears.blend"))
    left, right = vertices_near(dog, PLACES[4:])
    out = tmp_path / "mirror.blend"
    words = [f"{folder / 'ears.blend'}:Dog", "--mirror", "--pairs", f"{left}:{right}", "--transfer", "weights"]
    code, _, said = run(capfd, *words, "--names", "Ear.L", *QUICK, "--out", out)
    assert code == 0, said
    bpy.ops.wm.open_mainfile(filepath=str(out))
    weights = read_group(bpy.data.objects["Dog"], "Ear.R")
    assert weights[points[:, 1] < -0.6].min() > 0.5
    assert not weights[points[:, 1] > 0].any()


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (["FOX"], 3, "Name two meshes, or one mesh with --mirror"),
        (["FOX", "DOG", "--mirror"], 3, "Name two meshes, or one mesh with --mirror"),
        (["FOX", "--mirror", "--transfer", "uvs"], 3, "not UV maps"),
        (["FOX", "FOX"], 3, "Both names refer to Fox"),
        (["FOX", "DOG", "--pairs", "1:2", "--pairs-from", "groups"], 3, "cannot be combined"),
        (["FOX", "DOG", "--pairs-from", "empties"], 3, "no empties with the same names"),
        (["FOX", "DOG", "--pairs", "0:999999"], 3, "no vertex 999999"),
        (["FOX", "DOG", "--limit", "-1"], 3, "Limit must lie between 0 and 1000"),
        (["FOX", "NONE"], 3, "no object None"),
        (["FOX", "DOG", "--vertices", "3"], 3, "between 50 and 4000"),
        (["FOX", "DOG", "--pairs", "1-2"], 2, "not a pair of vertices"),
        (["FOX", "DOG", "--transfer", "hair"], 2, "invalid choice"),
        (
            ["FOX", "DOG", "--transfer", "weights", "--names", "Nope"],
            3,
            "Fox has no Nope to transfer; it has: Bottom, ",
        ),
        (["FOX", "DOG", "--transfer", "weights", "keys", "--names", "Top", "Tail"], 3, "Fox has no Tail to transfer"),
        (["FOX", "DOG", "--transfer", "keys", "--reverse"], 3, "Dog has no shape keys to transfer"),
        (
            ["FOX", "DOG", "--transfer", "keys", "colors", "--names", "Tall"],
            3,
            "Fox has no Tall to transfer; it has: Fur",
        ),
        (["FOX", "DOG", "--repair", "30"], 3, "The threshold must lie between 0 and 1"),
        (["FOX", "DOG", "--names", "Top"], 3, "--names requires --transfer"),
        (["FOX", "--mirror", "--transfer", "weights"], 3, "nothing to mirror among Bottom, "),
        (["FOX", "DOG", "--out", "/nowhere/at/all.blend"], 3, "does not exist"),
    ],
)
def test_impossible_requests_are_reported(files, tmp_path, capfd, words, code, message):
    folder, _ = files
    names = {"FOX": f"{folder / 'pets.blend'}:Fox", "DOG": f"{folder / 'pets.blend'}:Dog"}
    names["NONE"] = f"{folder / 'pets.blend'}:None"
    out = [] if "--out" in words else ["--out", tmp_path / "out.blend"]
    found, printed, said = run(capfd, *(names.get(word, word) for word in words), *out)
    assert found == code
    assert message in said
    # Errors are found before the work begins.
    assert "Computing the map: done" not in said
    assert not printed
    assert not (tmp_path / "out.blend").exists()
