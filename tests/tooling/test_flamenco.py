# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The job type for the render farm Flamenco: its tasks, and their command lines."""

from __future__ import annotations

import json
import shlex

import bpy
import pytest

from convwass_addon import cli
from convwass_addon.applications.morphs.runs import RUN_LENGTH
from tests.applications.maps import coarse_maps

quickjs = pytest.importorskip("quickjs", reason="no JavaScript engine: pip install quickjs-ng")

# The part of the Flamenco Manager's scripting interface that this script uses.
MANAGER = """"use strict";
const author = {
    Task: (name, type) => ({
        name, type, commands: [], dependencies: [],
        addCommand(command) { this.commands.push(command); },
        addDependency(task) { this.dependencies.push(task.name); },
    }),
    Command: (name, parameters) => ({ name, parameters }),
};
"""
COMPILE = """
(text) => {
    const job = { name: "job", settings: JSON.parse(text), tasks: [], addTask(task) { this.tasks.push(task); } };
    compileJob(job);
    return JSON.stringify(job.tasks);
}
"""
GIVEN = {
    "shapes": "/in/cow.obj; Duck ;C:\\in\\zoo.blend:Torus;",
    "frames": 12,
    "chunk_size": 8,
    "resolution": 64,
    "options": "",
    "output": "/out/morph.blend",
    "cache": "/out/frames",
    "blendfile": "/jobs/scene.blend",
}


@pytest.fixture(scope="module")
def script(project):
    context = quickjs.Context()
    context.add_callable("splitWords", lambda text: json.dumps(shlex.split(text)))
    context.eval(MANAGER + "const shellSplit = (text) => JSON.parse(splitWords(text));")
    context.eval((project / "assets" / "flamenco" / "convwass_morph.js").read_text(encoding="utf-8"))
    return context


def tasks(script, **settings):
    return json.loads(script.eval(COMPILE)(json.dumps(GIVEN | settings)))


def words_of(task):
    (command,) = task["commands"]
    assert command["name"] == "exec"
    assert command["parameters"]["exe"] == "{blender}"
    words = command["parameters"]["args"]
    assert words[:2] == ["--command", "convwass"]
    return words[2:]


def ranges(script, **settings):
    *bakes, _ = tasks(script, **settings)
    return [tuple(map(int, words_of(task)[-1].split("-"))) for task in bakes]


def test_chunks_and_a_final_task(script):
    *bakes, assemble = tasks(script)
    assert [task["name"] for task in bakes] == ["bake-0-7", "bake-8-15", "bake-16-23", "bake-24-24"]
    assert {task["type"] for task in [*bakes, assemble]} == {"blender"}
    assert all(task["dependencies"] == [] for task in bakes)
    assert assemble["name"] == "assemble"
    assert assemble["dependencies"] == [task["name"] for task in bakes]
    assert words_of(assemble) == [
        *["morph", "/in/cow.obj", "/jobs/scene.blend:Duck", "C:\\in\\zoo.blend:Torus"],
        *["--frames", "12", "--resolution", "64", "--out", "/out/morph.blend", "--cache", "/out/frames"],
    ]
    for task in bakes:
        assert words_of(task) == [*words_of(assemble), "--frames-range", task["name"].removeprefix("bake-")]


@pytest.mark.parametrize("frames", [2, 3, 4, 7, 8, 24])
@pytest.mark.parametrize("chunk_size", [1, 4, 5, 8, 1000])
def test_chunks_cover_every_frame_once_without_splitting_runs(script, frames, chunk_size):
    found = ranges(script, shapes="/a.obj;/b.obj", frames=frames, chunk_size=chunk_size)
    assert [frame for first, last in found for frame in range(first, last + 1)] == list(range(frames + 1))
    assert all(first % RUN_LENGTH == 0 for first, _ in found)
    assert len(found) == 1 or found[0][1] + 1 in range(chunk_size, chunk_size + RUN_LENGTH)


def test_other_options_are_split_like_in_a_shell(script):
    words = words_of(tasks(script, options="--sharpness 1 --export '/out/my mesh.ply'")[-1])
    at = words.index("--sharpness")
    assert words[at : at + 4] == ["--sharpness", "1", "--export", "/out/my mesh.ply"]


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"shapes": "Cow"}, "two of them"),
        ({"shapes": ""}, "shapes: this setting is missing"),
        ({"shapes": "Cow;Duck", "blendfile": None}, "blendfile: this setting is missing"),
        ({"frames": 1}, "frames: must be a whole number, 2"),
        ({"frames": 2.5}, "frames: must be a whole number"),
        ({"frames": None}, "frames: must be a whole number"),
        ({"chunk_size": 0}, "chunk_size: must be a whole number, 1"),
        ({"output": ""}, "output: this setting is missing"),
        ({"cache": None}, "cache: this setting is missing"),
    ],
)
def test_invalid_settings_are_refused(script, settings, message):
    with pytest.raises(quickjs.JSException, match=message):
        tasks(script, **settings)


def test_settings_are_described_as_flamenco_requires(script):
    job_type = json.loads(script.eval("JSON.stringify(JOB_TYPE)"))
    assert job_type["label"]
    assert {setting["key"] for setting in job_type["settings"]} == GIVEN.keys()
    for setting in job_type["settings"]:
        assert setting["type"] in {"string", "int32", "float", "bool"}
        assert setting.get("subtype", "file_path") in {"file_path", "dir_path", "file_name", "hashed_file_path"}
        assert setting.get("visible", "visible") in {"visible", "hidden", "submission", "web"}
        assert setting["description"]
        if "eval" in setting:
            compile(setting["eval"], setting["key"], "eval")


def test_selected_meshes_are_taken_from_left_to_right(script, empty_scene):
    job_type = json.loads(script.eval("JSON.stringify(JOB_TYPE)"))
    expression = next(setting["eval"] for setting in job_type["settings"] if setting["key"] == "shapes")
    for name, x in (("Duck", 5), ("Cow", 2), ("Torus", 9)):
        bpy.ops.mesh.primitive_cube_add(location=(x, 0, 0))
        bpy.context.object.name = name
    bpy.ops.object.light_add(location=(3, 0, 0))
    bpy.ops.object.select_all(action="SELECT")
    bpy.context.view_layer.update()
    assert eval(expression, {"C": bpy.context}) == "Cow; Duck; Torus"


def test_the_command_lines_work(script, empty_scene, tmp_path, capfd):
    scene, out, cache = tmp_path / "scene.blend", tmp_path / "morph.blend", tmp_path / "frames"
    for name, add in (("Cube", bpy.ops.mesh.primitive_cube_add), ("Ball", bpy.ops.mesh.primitive_ico_sphere_add)):
        add()
        bpy.context.object.name = name
    bpy.ops.wm.save_as_mainfile(filepath=str(scene))
    settings = {"blendfile": str(scene), "output": str(out), "cache": str(cache), "options": "--sharpness 0.5"}
    *bakes, assemble = tasks(script, shapes="Cube;Ball", frames=6, chunk_size=4, resolution=16, **settings)
    assert len(bakes) == 2
    # In any order, as on a farm.
    with coarse_maps():
        for task in reversed(bakes):
            assert cli.main(words_of(task)) == 0
            assert not out.exists()
        kept = {path: path.stat().st_mtime_ns for path in cache.iterdir()}
        assert len(kept) == 7
        assert cli.main(words_of(assemble)) == 0
    assert {path: path.stat().st_mtime_ns for path in cache.iterdir()} == kept
    bpy.ops.wm.open_mainfile(filepath=str(out))
    (collection,) = (c for c in bpy.data.collections if c.name.startswith("Morph"))
    assert sum(obj.type == "MESH" for obj in collection.objects) == 7
