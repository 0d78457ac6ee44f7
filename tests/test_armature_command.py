# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The command ``armature``: files, output and exit codes; the fit is replaced by a fake."""

from __future__ import annotations

import json
from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from convwass_addon import cli
from convwass_addon.applications.skeletons.inner_points import InnerPoint
from convwass_addon.bridge.armatures.pins import pin_joints, pinned_ends, register_pins, unregister_pins
from convwass_addon.bridge.armatures.rigs import rig_graph
from convwass_addon.cli import armature_command
from convwass_addon.progress import UNINTERRUPTED
from tests.rigs import chain, harmonic_steps, lines, tube, world_ends

pytestmark = [
    pytest.mark.usefixtures("empty_scene"),
    # Blender's own exporters under NumPy 2.5.
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
]


@pytest.fixture(autouse=True)
def asked(monkeypatch):
    """Record the requests for a fit, and place the joints between the pins."""
    calls = []

    def steps(mesh, graph, settings, control=UNINTERRUPTED):
        calls.append((mesh, graph, settings))
        return harmonic_steps(mesh, graph, settings, control)

    monkeypatch.setattr(armature_command, "fit_steps", steps)
    return calls


def save(path):
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    return path


@pytest.fixture
def scene(tmp_path):
    """A tube along X, and a chain next to it, in one file."""
    tube()
    chain(3).location = (0, 0, 5)
    return save(tmp_path / "scene.blend")


def run(tmp_path, *arguments):
    return cli.main(["armature", *map(str, arguments), "--out", str(tmp_path / "out.blend")])


def opened(tmp_path):
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "out.blend"))
    return bpy.data.objects


PINS = ("--pin", "A.head=0.5,0,0", "C.tail=3.5,0,0")


def test_a_rig_is_fitted_to_a_body(tmp_path, scene, capfd):
    report = tmp_path / "report.json"
    assert run(tmp_path, f"{scene}:Tube", f"{scene}:Rig", *PINS, "--report", report) == 0
    printed = capfd.readouterr().out.splitlines()
    assert printed == [str(tmp_path / "out.blend"), str(report)]
    rig = opened(tmp_path)["Rig"]
    found = world_ends(rig)
    np.testing.assert_allclose(found["A.tail"], (1.5, 0, 0), atol=1e-5)
    np.testing.assert_allclose(found["B.tail"], (2.5, 0, 0), atol=1e-5)
    assert pinned_ends(rig) == ["A.head", "C.tail"]
    assert rig_graph(rig).graph.lengths == pytest.approx([1, 1, 1])
    record = json.loads(report.read_text())
    assert (record["body"], record["rig"], record["fit"]["converged"]) == ("Tube", "Rig", True)
    assert record["joints"]["B.tail"]["position"] == pytest.approx([2.5, 0, 0], abs=1e-5)
    assert [joint["pinned"] for joint in record["joints"].values()] == [True, False, False, True]


def test_names_are_needed_only_where_there_is_a_choice(tmp_path, scene):
    assert run(tmp_path, scene, scene, *PINS) == 0


def test_the_result_as_json(tmp_path, scene, capfd):
    assert run(tmp_path, scene, scene, *PINS, "--json") == 0
    answer = json.loads(capfd.readouterr().out)
    assert answer["written"] == [str(tmp_path / "out.blend")]
    assert set(answer["joints"]) == {"A.head", "A.tail", "B.tail", "C.tail"}


def test_pins_and_settings_of_the_file_are_used(tmp_path, asked):
    tube()
    rig = chain(3)
    rig.data.bones["C"].use_deform = False
    pin_joints(rig, rig_graph(rig), [0])
    path = save(tmp_path / "pinned.blend")
    words = ("--blur", "0.005", "--lengths", "alike", "--links", "4", "--slack", "2", "--thickness", "0.1")
    words += ("--placement", "expected")
    assert run(tmp_path, path, path, "--pin", "B.tail", "--move-pins", *words) == 0
    ((_, graph, settings),) = asked
    assert graph.names == ("A.head", "A.tail", "B.tail")
    assert graph.pinned.tolist() == [True, False, True]
    assert (settings.gamma, settings.weights, settings.links) == (0.005, "uniform", 4)
    assert (settings.slack, settings.thickness, settings.outside_pins) == (2.0, 0.1, "move")
    assert settings.placement == "expected"
    assert run(tmp_path, path, path, "--pin", "C.tail", "--all-bones") == 0
    assert len(asked[1][1].names) == 4


def test_pinned_joints_move_inside_the_surface(tmp_path, scene, monkeypatch):
    finder = SimpleNamespace(find=lambda point: InnerPoint(np.array((point[0], 0.0, 0.0)), 0.4))
    monkeypatch.setattr(armature_command, "InnerPointFinder", lambda mesh: finder)
    places = ("--place", "A.head=0.5,0,0.4", "--place", "C.tail=3.5,0.4,0")
    assert run(tmp_path, scene, scene, *places) == 0
    np.testing.assert_allclose(world_ends(opened(tmp_path)["Rig"])["A.head"], (0.5, 0, 0), atol=1e-5)


def test_automatic_weights(tmp_path, scene, capfd):
    assert run(tmp_path, scene, scene, *PINS, "--auto-weights", "--json") == 0
    assert json.loads(capfd.readouterr().out)["unweighted"] == 0
    objects = opened(tmp_path)
    assert objects["Tube"].parent == objects["Rig"]
    assert {group.name for group in objects["Tube"].vertex_groups} == {"A", "B", "C"}


def test_meshes_of_edges_and_other_files(tmp_path, capfd):
    body = tube()
    bpy.ops.object.select_all(action="DESELECT")
    body.select_set(True)
    # The axes of the file are those of the scene.
    bpy.ops.wm.obj_export(
        filepath=str(tmp_path / "tube.obj"), export_selected_objects=True, forward_axis="NEGATIVE_Z", up_axis="Y"
    )
    (tmp_path / "lines.obj").write_text("v 0.5 0 0\nv 1 3 0\nv 3.5 0 0\nl 1 2\nl 2 3\n")
    assert run(tmp_path, tmp_path / "tube.obj", tmp_path / "lines.obj", "--pin", "0", "2", "--lengths", "alike") == 0
    edges = opened(tmp_path)["lines"]
    assert pinned_ends(edges) == ["0", "2"]
    assert abs(edges.data.vertices[1].co.y) < 1e-5
    assert run(tmp_path, tmp_path / "tube.obj", tmp_path / "lines.obj", "--pin", "0", "--auto-weights") == 3
    assert "is not an armature, so it cannot provide weights" in capfd.readouterr().err


def test_a_rig_of_another_blend(tmp_path):
    tube()
    body = save(tmp_path / "body.blend")
    parent = bpy.data.objects.new("Holder", None)
    bpy.context.collection.objects.link(parent)
    lines([(0, 0, 0), (1, 0, 0)], [(0, 1)])
    chain(3).parent = parent
    rigs = save(tmp_path / "rigs.blend")
    for words in ((body, f"{rigs}:Rig"), (body, rigs), (f"{body}:Tube", f"{rigs}:Rig")):
        assert run(tmp_path, *words, *PINS) == 0
        objects = opened(tmp_path)
        assert {"Tube", "Rig"} <= set(objects.keys())
        assert "Lines" not in objects
    assert objects["Rig"].parent == objects["Holder"]


def test_an_armature_of_an_exchange_format(tmp_path, capfd):
    tube()
    body = save(tmp_path / "body.blend")
    obj, skin = chain(3), tube()
    skin.parent = obj
    for name in "ABC":
        skin.vertex_groups.new(name=name).add(list(range(len(skin.data.vertices))), 0.3, "REPLACE")
    skin.modifiers.new("Armature", "ARMATURE").object = obj
    bpy.ops.export_scene.gltf(filepath=str(tmp_path / "rig.glb"))
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    assert run(tmp_path, body, tmp_path / "rig.glb", "--pin", "A.head", "B.tail=3,0,0") == 0
    kinds = sorted(obj.type for obj in opened(tmp_path))
    assert kinds == ["ARMATURE", "MESH"]


def test_without_the_add_on(tmp_path, scene):
    """As from ``python -m convwass_addon``."""
    unregister_pins()
    try:
        assert run(tmp_path, scene, scene, *PINS) == 0
        assert not hasattr(bpy.types.Bone, "convwass_pinned")
    finally:
        register_pins()
    assert pinned_ends(opened(tmp_path)["Rig"]) == ["A.head", "C.tail"]


@pytest.fixture
def two_of_each(tmp_path):
    for name in ("Rig", "Other"):
        tube()
        chain(2, name=name)
    return save(tmp_path / "two.blend")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("{scene}", "{scene}"), "No joint is pinned; name some with --pin, such as A.head"),
        (("{scene}", "{scene}", "--pin", "Z.tail"), "There is no joint Z.tail"),
        (("{scene}", "{scene}", "--place", "Z.tail=0,0,0"), "There is no joint Z.tail"),
        (("{scene}:Tube", "{scene}:Tube"), "Both names refer to Tube"),
        (("{scene}:Nobody", "{scene}"), "has no object 'Nobody'; it contains Rig, Tube"),
        (("{scene}", "{scene}:Nobody"), "has no object 'Nobody'; it contains Rig, Tube"),
        (("{two}:Tube", "{two}"), "contains 2 skeletons; name one"),
        (("{two}", "{two}:Rig"), "contains 2 meshes; name one"),
        (("{scene}", "{lonely}"), "contains no armature and no mesh of edges"),
        (("{scene}", "{lonely}:Rig"), "has no object 'Rig'; it contains Tube"),
        (("{missing}", "{scene}"), "does not exist; check the spelling"),
        (("{scene}", "{folder}"), "is a folder; name a file in it"),
        (("{scene}", "{text}"), "is of an unknown format"),
        (("{broken}", "{scene}"), "could not be read; it is damaged"),
        (("{scene}", "{broken}"), "could not be read; it is damaged"),
        (("{scene}:Rig", "{scene}:Tube"), "has faces; a skeleton must be an armature"),
        (("{scene}", "{scene}", "--blur", "-1"), "Blur (gamma) must lie between 1e-05 and 1, not -1"),
        (("{scene}", "{scene}", "--report", "{folder}"), "is a folder"),
    ],
)
def test_impossible_requests_are_reported(tmp_path, scene, two_of_each, capfd, words, message):
    tube()
    paths = {
        "scene": scene,
        "two": two_of_each,
        "lonely": save(tmp_path / "lonely.blend"),
        "missing": tmp_path / "missing.blend",
        "folder": tmp_path,
        "text": tmp_path / "notes.txt",
        "broken": tmp_path / "broken.blend",
    }
    paths["text"].write_text("no rig")
    paths["broken"].write_text("no blend")
    assert run(tmp_path, *(word.format(**paths) for word in words)) == 3
    assert message in capfd.readouterr().err
    assert not (tmp_path / "out.blend").exists()


@pytest.mark.parametrize("word", ["A.tail=1,2", "A.tail=x,y,z", "A.tail=1,nan,0", "A.tail=inf,0,0", "=1,2,3"])
def test_invalid_pins_are_refused(tmp_path, scene, word):
    assert run(tmp_path, scene, scene, "--pin", word) == 2
    assert run(tmp_path, scene, scene, "--place", word) == 2


def test_a_hidden_rig(tmp_path, capfd):
    tube()
    chain(2).hide_viewport = True
    path = save(tmp_path / "hidden.blend")
    assert run(tmp_path, path, path, "--pin", "A.head") == 3
    assert "Rig or its collection is hidden" in capfd.readouterr().err
