# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: files, output and exit codes."""

from __future__ import annotations

import json
import os
import shlex
import signal
import subprocess
import sys
import time
from dataclasses import replace

import bpy
import numpy as np
import pytest

from convwass_addon import cli
from convwass_addon.applications import memory
from convwass_addon.applications.morphs.diagnostics import Diagnostic
from convwass_addon.applications.morphs.morph import morph
from convwass_addon.applications.one_mesh.key_paths import KeyPath
from convwass_addon.applications.one_mesh.swapped_meshes import SwappedMeshes
from convwass_addon.bridge.morphs import bake, job
from convwass_addon.bridge.morphs.job import MorphJob
from convwass_addon.bridge.nodes.node_trees import own_tree
from convwass_addon.bridge.one_mesh import shape_key_job, swap_job
from convwass_addon.cli import interrupts, morph_baking, program
from convwass_addon.errors import Cancelled, ConvwassError
from convwass_addon.progress import Progress
from convwass_addon.sentence import Sentence
from tests.clusters import local_cluster
from tests.operators.morphs import baked_morph

pytestmark = [
    pytest.mark.usefixtures("empty_scene"),
    # Blender's own exporters under NumPy 2.5.
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
]

TRANSPORT = ["morph", "--motion", "transport"]
QUICK = ["--resolution", "24", "--frames", "2"]


@pytest.fixture
def shapes(tmp_path, empty_scene):
    """A cube as OBJ, a ball as PLY, a cone as STL and all three in a .blend."""
    folder = tmp_path / "in"
    folder.mkdir()
    writers = {
        "cube.obj": (bpy.ops.mesh.primitive_cube_add, bpy.ops.wm.obj_export, "export_selected_objects"),
        "ball.ply": (bpy.ops.mesh.primitive_ico_sphere_add, bpy.ops.wm.ply_export, "export_selected_objects"),
        "cone.stl": (bpy.ops.mesh.primitive_cone_add, bpy.ops.wm.stl_export, "export_selected_objects"),
    }
    for name, (make, write, selection) in writers.items():
        bpy.ops.object.select_all(action="DESELECT")
        make()
        bpy.context.object.name = name.partition(".")[0].title()
        write(filepath=str(folder / name), **{selection: True})
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "all.blend"))
    return folder


def cube_and_ball(shapes):
    return [str(shapes / "cube.obj"), str(shapes / "ball.ply")]


def saved_frames(path):
    bpy.ops.wm.open_mainfile(filepath=str(path))
    return [obj for obj in baked_morph().objects if obj.type == "MESH"]


def test_a_path_through_three_formats(shapes, tmp_path):
    out = tmp_path / "morph.blend"
    files = [str(shapes / name) for name in ("cube.obj", "ball.ply", "cone.stl")]
    assert cli.main([*TRANSPORT, *files, *QUICK, "--out", str(out)]) == 0
    assert len(saved_frames(out)) == 5


def test_objects_of_a_blend_and_a_single_blend(shapes, tmp_path):
    out = tmp_path / "morph.blend"
    words = [f"{shapes / 'all.blend'}:{name}" for name in ("Cube", "Ball", "Cone")]
    assert cli.main([*TRANSPORT, *words, "--weights", "2,1,1", "--resolution", "24", "--out", str(out)]) == 0
    (blend,) = saved_frames(out)
    assert list(blend["convwass_weights"]) == pytest.approx([0.5, 0.25, 0.25])


def test_shapes_can_be_aligned_with_the_first(shapes, tmp_path):
    out = tmp_path / "morph.blend"
    words = [f"{shapes / 'all.blend'}:{name}" for name in ("Cube", "Ball")]
    options = ["--align", "principal-axes", "--scale", "equal-volume", *QUICK]
    assert cli.main([*TRANSPORT, *words, *options, "--out", str(out)]) == 0
    first, _, last = saved_frames(out)
    low, high = (np.array(obj.bound_box).reshape(8, 3)[[0, 6]] for obj in (first, last))
    np.testing.assert_allclose(low.mean(axis=0), high.mean(axis=0), atol=1e-3)


@pytest.mark.parametrize(("output", "files"), [("player", 0), ("volume", 3), ("alembic", 1), ("usd", 1)])
def test_outputs_show_every_frame(shapes, tmp_path, capfd, output, files):
    out = tmp_path / "morph.blend"
    words = [*cube_and_ball(shapes), "--output", output]
    capfd.readouterr()
    assert cli.main([*TRANSPORT, *words, *QUICK, "--out", str(out)]) == 0
    assert len(capfd.readouterr().out.splitlines()) >= 1 + files
    # No backup of a first state, and no draft, is left.
    assert [path.name for path in tmp_path.iterdir() if path.is_file()] == ["morph.blend"]
    bpy.ops.wm.open_mainfile(filepath=str(out))
    assert (
        len(list((tmp_path / "morph files").rglob("*.*"))) == files
        if files
        else not (tmp_path / "morph files").exists()
    )
    (shown,) = [obj for obj in bpy.data.objects if obj.type == "MESH" and obj.modifiers and obj.visible_get()]
    for frame in (1, 2, 3):
        bpy.context.scene.frame_set(frame)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        assert len(shown.evaluated_get(depsgraph).to_mesh().vertices) > 7, frame


@pytest.mark.parametrize(("layout", "count", "expected"), [("triangle", 3, 6), ("grid", 4, 9)])
def test_sheets(shapes, tmp_path, layout, count, expected):
    out = tmp_path / "sheet.blend"
    words = [str(shapes / name) for name in ("cube.obj", "ball.ply", "cone.stl", "cube.obj")][:count]
    assert cli.main([*TRANSPORT, *words, "--layout", layout, "--steps", "3", *QUICK, "--out", str(out)]) == 0
    assert len(saved_frames(out)) == expected


def test_json_is_all_that_standard_output_holds(shapes, tmp_path, capfd):
    out = tmp_path / "morph.blend"
    words = cube_and_ball(shapes)
    options = ["--json", "--sharpness", "0.5", "--entropy-limit", "max", "--export", str(tmp_path / "mesh.obj")]
    (tmp_path / "mesh_0004.obj").touch()
    capfd.readouterr()
    assert cli.main([*TRANSPORT, *words, *QUICK, *options, "--out", str(out)]) == 0
    printed, said = capfd.readouterr()
    assert "also contains mesh_0004.obj, not written by this run" in said
    (tmp_path / "mesh_0004.obj").unlink()
    result = json.loads(printed)
    assert result["settings"]["sharpness"] == 0.5
    blend = result["frames"][1]
    assert blend["converged"]
    assert blend["volume"] == pytest.approx(blend["volume_wanted"], rel=0.01)
    assert blend["mass_error"] < 5e-3
    assert sorted(p.name for p in tmp_path.glob("*.obj")) == ["mesh_0001.obj", "mesh_0002.obj", "mesh_0003.obj"]


def test_diagnostics_are_told(shapes, tmp_path, capfd, monkeypatch):
    notes = [Diagnostic("GOOD", {}), Diagnostic("MERGED", {}), Diagnostic("GUIDES", {"count": 2})]
    monkeypatch.setattr(bake, "diagnose", lambda *_arguments: notes)
    capfd.readouterr()
    assert cli.main([*TRANSPORT, *cube_and_ball(shapes), *QUICK, "--out", str(tmp_path / "morph.blend")]) == 0
    said = capfd.readouterr().err
    assert "convwass: Warp was chosen: at least one of the shapes has no limbs\n" in said
    assert "convwass: Guides left out: 2; the shapes map better without them" in said
    assert "as exact as asked for" not in said
    assert "open edges" not in said


def test_holes_are_told(tmp_path, capfd):
    for name, height in (("box", 0.0), ("other", 1.0)):
        corners = "".join(f"v {x} {y} {z + height}\n" for z in (0, 1) for y in (0, 1) for x in (0, 1))
        sides = "f 1 3 4 2\nf 1 2 6 5\nf 2 4 8 6\nf 4 3 7 8\nf 3 1 5 7\n"
        (tmp_path / f"{name}.obj").write_text(corners + sides + ("f 5 6 8 7\n" if name == "other" else ""))
    words = [str(tmp_path / "box.obj"), str(tmp_path / "other.obj"), *QUICK, "--out", str(tmp_path / "morph.blend")]
    capfd.readouterr()
    assert cli.main([*TRANSPORT, *words]) == 0
    said = capfd.readouterr().err
    assert "box has holes with 4 open edges; the volume that they nearly enclose is filled" in said
    assert "other has holes" not in said


def test_written_files_are_named(shapes, tmp_path, capfd):
    out = tmp_path / "morph.blend"
    capfd.readouterr()
    assert cli.main([*TRANSPORT, *cube_and_ball(shapes), *QUICK, "--out", str(out)]) == 0
    assert capfd.readouterr().out.split() == [str(out)]


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (["{in}/cube.obj", "{in}/ball.ply", "--parts", "vertex-groups"], 3, "No part is on all shapes"),
        (["{in}/cube.obj", "{in}/missing.obj"], 3, "does not exist"),
        (["{in}/cube.obj", "{in}"], 3, "folder"),
        (["{in}/cube.obj"], 3, "two shapes"),
        (["{in}/cube.obj", "{in}/all.blend:Nobody"], 3, "Nobody"),
        (["{in}/cube.obj", "{in}/ball.ply", "--out", "{in}/nowhere/morph.blend"], 3, "nowhere"),
        (["{in}/cube.obj", "{in}/ball.ply", "--weights", "1,2,3"], 3, "there are 3"),
        (["{in}/cube.obj", "{in}/ball.ply", "--weights", "0,0"], 3, "zero"),
        (["{in}/cube.obj", "{in}/ball.ply", "--weights", "1,1", "--layout", "path"], 3, "leave out --layout"),
        (["{in}/cube.obj", "{in}/ball.ply", "--weights", "1,-1"], 3, "positive"),
        (["{in}/cube.obj", "{in}/ball.ply", "--weights", "a,b"], 2, "list of numbers"),
        (["{in}/cube.obj", "{in}/ball.ply", "--layout", "grid"], 3, "four shapes"),
        (["{in}/cube.obj", "{in}/ball.ply", "--sharpness", "2"], 3, "Sharpness"),
        (["{in}/cube.obj", "{in}/ball.ply", "--resolution", "4"], 3, "Resolution"),
        (["{in}/cube.obj", "{in}/ball.ply", "--frames", "1"], 3, "Frames must lie between 2 and"),
        (["{in}/cube.obj", "{in}/ball.ply", "--export", "{in}/mesh.xyz"], 3, ".obj"),
        (["{in}/cube.obj", "{in}/ball.ply", "--entropy-limit", "much"], 2, "off, max or a number"),
        (["{in}/cube.obj", "{in}/ball.ply", "--workers", "0"], 3, "at least one worker"),
        (["{in}/cube.obj", "{in}/ball.ply", "--workers", "2", "--scheduler", "tcp://a:1"], 3, "choose one of them"),
        (["{in}/cube.obj", "{in}/ball.ply", "--scheduler", "what://ever"], 3, "scheduler"),
        (["{in}/cube.obj", "{in}/ball.ply", "--cache", "{in}/cube.obj"], 3, "cannot be made"),
        (["{in}/cube.obj", "{in}/ball.ply", "--frames-range", "0-3"], 3, "requires --cache"),
        (["{in}/cube.obj", "{in}/ball.ply", "--frames-range", "0-25", "--cache", "{in}/frames"], 3, "frames 0-24"),
        (["{in}/cube.obj", "{in}/ball.ply", "--frames-range", "3-2", "--cache", "{in}/frames"], 2, "range of frames"),
        (["{in}/cube.obj", "{in}/ball.ply", "--frames-range=-1", "--cache", "{in}/frames"], 2, "range of frames"),
        (["{in}/cube.obj", "{in}/ball.ply", "--frames-range", "all", "--cache", "{in}/frames"], 2, "range of frames"),
        (["{in}/cube.obj", "{in}/ball.ply", "--frames-range", "٣", "--cache", "{in}/frames"], 2, "range of frames"),
        (
            ["{in}/cube.obj", "{in}/ball.ply", "--frames-range", "0", "--cache", "{in}/frames", "--weights", "1,1"],
            3,
            "requires a path",
        ),
        (
            ["{in}/cube.obj", "{in}/ball.ply", "--frames-range", "0", "--cache", "{in}/frames", "--render"],
            3,
            "use --render",
        ),
        (["{in}/cube.obj", "{in}/ball.ply", "--at", "0.5"], 3, "--at requires --cache"),
        (["{in}/cube.obj", "{in}/ball.ply", "--at", "24.5", "--cache", "{in}/frames"], 3, "frames 0-24"),
        (["{in}/cube.obj", "{in}/ball.ply", "--at=-1", "--cache", "{in}/frames"], 3, "frames 0-24"),
        (["{in}/cube.obj", "{in}/ball.ply", "--at", "nan", "--cache", "{in}/frames"], 3, "not on the path"),
        (["{in}/cube.obj", "{in}/ball.ply", "--at", "2.5,2.5", "--cache", "{in}/frames"], 3, "there twice"),
        (["{in}/cube.obj", "{in}/ball.ply", "--at", "soon", "--cache", "{in}/frames"], 2, "list of numbers"),
        (
            ["{in}/cube.obj", "{in}/ball.ply", "--at", "1.5", "--cache", "{in}/f", "--weights", "1,1"],
            3,
            "requires a path",
        ),
        (["{in}/cube.obj", "{in}/ball.ply", "--at", "1", "--cache", "{in}/f", "--frames-range", "0"], 3, "one of them"),
        (["{in}/cube.obj", "{in}/ball.ply", "--weights", "1,1", "--output", "usd"], 3, "do not move"),
        (["{in}/cube.obj", "{in}/ball.ply", "--weights", "1,1", "--output", "player"], 3, "do not move"),
        (["{in}/cube.obj", "{in}/ball.ply", "--at", "1", "--cache", "{in}/f", "--output", "player"], 3, "do not move"),
        (
            ["{in}/cube.obj", "{in}/ball.ply", "{in}/cone.stl", "--layout", "triangle", "--output", "player"],
            3,
            "do not move",
        ),
        (["{in}/cube.obj", "{in}/ball.ply", "--output", "pad"], 3, "--output pad requires a sheet; use --layout grid"),
        (["{in}/cube.obj", "{in}/ball.ply", "--weights", "1,1", "--output", "pad"], 3, "--output pad requires a sheet"),
        (["{in}/cube.obj", "{in}/ball.ply", "--textures"], 3, "--output shape-keys"),
        (
            ["{in}/cube.obj", "{in}/ball.ply", "--output", "shape-keys", "--two-meshes", "--textures"],
            3,
            "leave out --textures",
        ),
        (["{in}/cube.obj", "{in}/ball.ply", "--two-meshes"], 3, "--two-meshes requires --output shape-keys"),
        (["{in}/cube.obj", "{in}/ball.ply", "--symmetric"], 3, "--symmetric requires --output shape-keys"),
        (["{in}/cube.obj", "{in}/ball.ply", "--basis", "even"], 3, "--basis requires --output shape-keys"),
        (["{in}/cube.obj", "{in}/ball.ply", "--key-error", "1"], 3, "--key-error requires --output shape-keys"),
        (["{in}/cube.obj", "{in}/ball.ply", "--texture-size", "64"], 3, "requires --output shape-keys --textures"),
        (
            ["{in}/cube.obj", "{in}/ball.ply", "--output", "shape-keys", "--texture-folder", "{in}"],
            3,
            "--texture-folder requires --output shape-keys --textures",
        ),
        (["{in}/cube.obj", "{in}/ball.ply", "--output", "shape-keys", "--render"], 3, "leave out --render"),
        (["{in}/cube.obj", "{in}/ball.ply", "--output", "shape-keys", "--at", "1"], 3, "leave out --at"),
        (["{in}/cube.obj", "{in}/ball.ply", "--output", "shape-keys", "--weights", "1,1"], 3, "leave out --weights"),
        (["{in}/cube.obj", "{in}/ball.ply", "--output", "shape-keys", "--looks", "front"], 3, "leave out --looks"),
        (["{in}/all.blend:Cube", "{in}/all.blend:Ball", "--output", "shape-keys", "--follow"], 3, "leave out --follow"),
        (
            ["{in}/all.blend:Cube", "{in}/all.blend:Ball", "--at", "1", "--cache", "{in}/f", "--follow"],
            3,
            "--at requires inputs at rest; leave out --follow",
        ),
        (["{in}/cube.obj", "{in}/ball.ply", "--nonsense"], 2, "nonsense"),
        ([], 2, "SHAPE"),
    ],
)
def test_errors_have_codes_and_instructions(shapes, tmp_path, capfd, monkeypatch, words, code, message):
    # Nothing is solved before an error is found.
    monkeypatch.setattr(MorphJob, "write", None)
    before = sorted(tmp_path.rglob("*"))
    words = [word.replace("{in}", str(shapes)) for word in words]
    if "--out" not in words:
        words += ["--out", str(tmp_path / "morph.blend")]
    assert cli.main([*TRANSPORT, *words]) == code
    assert message in capfd.readouterr().err
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize(
    ("taken", "words"),
    [
        ("morph.png", ["--render"]),
        ("morph.mp4", ["--render"]),
        ("frame_0002.ply", ["--export", "{at}/frame.ply"]),
        ("morph files", ["--output", "volume"]),
        ("no folder", ["--output", "shape-keys", "--textures", "--texture-folder", "{at}/no folder/images"]),
    ],
)
def test_places_of_other_files_are_checked_before_the_work(shapes, tmp_path, capfd, monkeypatch, taken, words):
    monkeypatch.setattr(MorphJob, "write", None)
    monkeypatch.setattr(shape_key_job, "key_paths", None)
    if taken in ("morph files", "no folder"):
        (tmp_path / taken).touch()
    else:
        (tmp_path / taken).mkdir()
    inputs = [*cube_and_ball(shapes), "--out", str(tmp_path / "morph.blend")]
    assert cli.main(["morph", *inputs, *QUICK, *(word.format(at=tmp_path) for word in words)]) == 3
    assert taken in capfd.readouterr().err


@pytest.mark.parametrize("folder", ["{at}/images", "//images"])
def test_one_mesh_gets_images_of_both_looks(shapes, tmp_path, capfd, monkeypatch, folder):
    """In a folder beside the file, which Blender calls //."""

    def moved(meshes, names, *_):
        yield Progress(0.5, Sentence("Half"))
        poor = np.array([3, 5])
        return [KeyPath(names[1], (1.0,), meshes[0].vertices[None] * 0.5, 0.9, 0.0, 0.1, 0.5, 0, poor, missed=0.08)]

    monkeypatch.setattr(shape_key_job, "key_paths", moved)
    coat = bpy.data.materials.new("Coat")
    own_tree(coat).nodes["Principled BSDF"].inputs["Base Color"].default_value = (1.0, 0.0, 0.0, 1.0)
    bpy.data.objects["Cube"].data.materials.append(coat)
    bpy.ops.wm.save_as_mainfile(filepath=str(shapes / "all.blend"))
    words = ["morph", *(f"{shapes / 'all.blend'}:{name}" for name in ("Cube", "Ball"))]
    words += ["--output", "shape-keys", "--textures", "--texture-size", "16", "--texture-samples", "1"]
    words += ["--texture-folder", folder.format(at=tmp_path), "--out", str(tmp_path / "keys.blend")]
    assert cli.main(words) == 0
    said = capfd.readouterr()
    named = said.out.split("\n")
    assert "Cube Morph: one shape key; 95 % of the mesh ends within " in said.err
    assert "2 vertices are folded or do not arrive at Ball; an attribute marks them: add guides there" in said.err
    assert "8% of the surface of Ball is missed: the mesh has too few vertices there" in said.err
    assert str(tmp_path / "keys.blend") in named
    written = list((tmp_path / "images").iterdir())
    assert written and {str(file) for file in written} < set(named)
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "keys.blend"))
    (obj,) = (obj for obj in bpy.data.objects if obj.name.endswith("Morph"))
    assert obj.data.materials[-1].name == f"{obj.name} Baked"
    assert {bpy.path.abspath(image.filepath) for image in bpy.data.images if image.source == "FILE"} == {
        str(file) for file in written
    }


def test_two_meshes_follow_a_morph_of_the_given_threads(shapes, tmp_path, monkeypatch, capfd):
    asked = []

    def swapped(inputs, error, settings, control, how):
        asked.append(how.workers)
        yield Progress(0.5, Sentence("Half"))
        still = [
            KeyPath("Other", (1.0,), mesh.vertices[None], None, 0.0, 0.0, 0.0, 0, poor=np.array([7]))
            for mesh in inputs.shapes
        ]
        return SwappedMeshes(*still, 0.5, 0.001)

    monkeypatch.setattr(swap_job, "swapped_meshes", swapped)
    words = ["morph", *cube_and_ball(shapes), "--output", "shape-keys", "--two-meshes"]
    assert cli.main([*words, "--workers", "1", "--out", str(tmp_path / "keys.blend"), "--json"]) == 0
    assert asked == [1]
    said = capfd.readouterr()
    assert "ball Morph replaces cube Morph at 0.50; 98 % of both are within 0.10% of the morph there" in said.err
    assert any("1 vertices are folded" in notice for notice in json.loads(said.out)["notices"])


def test_too_much_memory_has_its_own_code(shapes, tmp_path, capfd, monkeypatch):
    monkeypatch.setattr(memory, "available_memory", lambda: 10_000_000)
    words = [*cube_and_ball(shapes), "--out", str(tmp_path / "morph.blend")]
    assert cli.main([*TRANSPORT, *words, "--resolution", "200"]) == 4
    assert "would fit" in capfd.readouterr().err
    assert not (tmp_path / "morph.blend").exists()


def test_damaged_files_are_refused(shapes, tmp_path, capfd):
    damaged = tmp_path / "damaged.ply"
    damaged.write_bytes(b"ply\nformat binary_little_endian 1.0\nelement vertex 900\n\x00\x01")
    assert cli.main([*TRANSPORT, str(shapes / "cube.obj"), str(damaged), "--out", str(tmp_path / "m.blend")]) == 3
    assert "damaged.ply" in capfd.readouterr().err


def test_ranges_fill_a_cache_and_the_last_run_takes_all_from_it(shapes, tmp_path, capfd):
    out, cache = tmp_path / "morph.blend", tmp_path / "frames"
    words = [*TRANSPORT, *cube_and_ball(shapes), "--resolution", "16", "--frames", "10"]
    words += ["--out", str(out), "--cache", str(cache), "--json"]
    made = []
    for wanted in ("5", "0-1", "8-10"):
        capfd.readouterr()
        assert cli.main([*words, "--frames-range", wanted]) == 0
        printed, said = capfd.readouterr()
        result = json.loads(printed)
        first, last = result["range"]
        assert f"frames {first}-{last} of 10 are in {cache}" in said
        assert len(result["frames"]) == last - first + 1
        assert result["written"] == [str(cache)]
        made.append((first, last))
    assert made == [(4, 7), (0, 3), (8, 10)]
    assert not out.exists()
    before = {path: path.stat().st_mtime_ns for path in cache.iterdir()}
    assert len(before) == 11
    assert cli.main(words) == 0
    cached = json.loads(capfd.readouterr().out)["frames"]
    assert {path: path.stat().st_mtime_ns for path in cache.iterdir()} == before
    assert len(saved_frames(out)) == 11
    capfd.readouterr()
    assert cli.main([word for word in words if word not in ("--cache", str(cache))]) == 0
    assert json.loads(capfd.readouterr().out)["frames"] == cached


def test_a_cluster_computes_the_same_frames_as_threads(shapes, tmp_path, capfd):
    words = [*TRANSPORT, *cube_and_ball(shapes), *QUICK, "--json"]
    words += ["--out", str(tmp_path / "morph.blend")]
    results = []
    with local_cluster(n_workers=1, threads_per_worker=1, processes=False, protocol="tcp") as cluster:
        for where in (["--scheduler", cluster.scheduler_address], ["--workers", "1"]):
            capfd.readouterr()
            assert cli.main([*words, *where]) == 0
            results.append(json.loads(capfd.readouterr().out))
    assert results[0] == results[1]


@pytest.mark.parametrize(
    ("cache", "left"), [([], "unfinished files were not saved"), (["--cache", "{at}"], "are kept in {at}")]
)
def test_an_interrupt_reports_what_remains(shapes, tmp_path, capfd, monkeypatch, cache, left):
    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(MorphJob, "write", interrupt)
    words = [*cube_and_ball(shapes), *QUICK, "--out", str(tmp_path / "morph.blend")]
    at = str(tmp_path / "frames")
    assert cli.main([*TRANSPORT, *words, *(word.format(at=at) for word in cache)]) == 130
    assert left.format(at=at) in capfd.readouterr().err
    assert not (tmp_path / "morph.blend").exists()


@pytest.mark.skipif(sys.platform == "win32", reason="signals are POSIX")
@pytest.mark.parametrize(("name", "code"), [("SIGINT", 130), ("SIGTERM", 143), ("SIGHUP", 129)])
def test_signals_end_a_command_with_their_number(shapes, tmp_path, capfd, monkeypatch, name, code):
    number, cleaned = getattr(signal, name), []
    # The tests may run in the background, which ignores some signals.
    expected = signal.default_int_handler if name == "SIGINT" else signal.SIG_DFL
    before = signal.signal(number, expected)

    def stopped(*_):
        try:
            signal.raise_signal(number)
        finally:
            cleaned.append(name)

    monkeypatch.setattr(MorphJob, "write", stopped)
    words = [*TRANSPORT, *cube_and_ball(shapes), *QUICK, "--out", str(tmp_path / "morph.blend")]
    try:
        found = cli.main(words)
    finally:
        after = signal.signal(number, before)
    assert (found, cleaned, after) == (code, [name], expected)
    assert "convwass: interrupted; unfinished files were not saved" in capfd.readouterr().err
    assert list(tmp_path.iterdir()) == [shapes]


@pytest.mark.skipif(sys.platform == "win32", reason="signals are POSIX")
def test_a_signal_that_the_caller_ignores_is_ignored(shapes, tmp_path, monkeypatch):
    """As after nohup."""
    begin = MorphJob.write

    def hung_up(self, report):
        signal.raise_signal(signal.SIGHUP)
        begin(self, report)

    monkeypatch.setattr(MorphJob, "write", hung_up)
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        words = [*TRANSPORT, *cube_and_ball(shapes), *QUICK, "--out", str(tmp_path / "morph.blend")]
        assert cli.main(words) == 0
        assert signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGHUP, before)


@pytest.mark.parametrize(("seconds", "told"), [(0.0, False), (0.5, True)])
def test_an_interrupt_is_answered_where_the_work_does_not_end_at_once(monkeypatch, capfd, seconds, told):
    """The main thread does not run Python until it has slept, as while Blender renders."""
    monkeypatch.setattr(interrupts, "_PATIENCE", 0.05)
    before = signal.signal(signal.SIGINT, lambda *_: None)
    try:
        with interrupts.heeded_signals():
            signal.raise_signal(signal.SIGINT)
            time.sleep(seconds)
    finally:
        signal.signal(signal.SIGINT, before)
    assert ("is finished first" in capfd.readouterr().err) == told


# Pictures end like this.
NEW, OLD = b"new IEND\xaeB`\x82", b"old"


def rendering(error=None):
    """Return what stands in for rendering a picture or a movie, or is stopped by an error."""

    def render(collection, path, **options):
        yield Progress(0.5, Sentence("Rendering"))
        if error is not None:
            raise error
        path.write_bytes(NEW)
        return path

    return render


@pytest.mark.parametrize(
    ("error", "code", "message"),
    [
        (None, 0, ""),
        (KeyboardInterrupt(), 130, "interrupted; unfinished files were not saved"),
        (Cancelled("The rendering was stopped."), 130, "interrupted; unfinished files were not saved"),
        (ConvwassError("No video output."), 1, "No video output."),
    ],
)
def test_a_picture_is_there_only_with_its_movie(shapes, tmp_path, capfd, monkeypatch, error, code, message):
    monkeypatch.setattr(morph_baking, "render_contact_sheet", rendering())
    monkeypatch.setattr(morph_baking, "render_animation", rendering(error))
    rendered = [tmp_path / "morph.png", tmp_path / "morph.mp4"]
    for path in rendered:
        path.write_bytes(OLD)
    words = [*TRANSPORT, *cube_and_ball(shapes), *QUICK, "--out", str(tmp_path / "morph.blend"), "--render"]
    assert cli.main(words) == code
    told = capfd.readouterr()
    assert message in told.err
    assert [path.read_bytes() for path in rendered] == 2 * [NEW if code == 0 else OLD]
    assert (tmp_path / "morph.blend").exists() == (code == 0)
    assert all((str(path) in told.out) == (code == 0) for path in rendered)


def test_damaged_frames_in_a_cache_are_named(shapes, tmp_path, capfd):
    cache = tmp_path / "frames"
    words = [*TRANSPORT, *cube_and_ball(shapes), "--resolution", "16", "--frames", "2"]
    words += ["--out", str(tmp_path / "morph.blend"), "--cache", str(cache)]
    assert cli.main(words) == 0
    damaged = next(cache.iterdir())
    damaged.write_bytes(b"nonsense")
    capfd.readouterr()
    assert cli.main(words) == 0
    assert f"{damaged} cannot be used and is made again" in capfd.readouterr().err


def test_between_frames_of_a_cache(shapes, tmp_path, capfd):
    out, cache = tmp_path / "between.blend", tmp_path / "frames"
    words = [*TRANSPORT, str(shapes / "cube.obj"), str(shapes / "cone.stl"), "--resolution", "24", "--frames", "8"]
    words += ["--cache", str(cache), "--at", "4.25,5,5.5", "--out", str(out), "--json"]
    capfd.readouterr()
    assert cli.main([*words, "--export", str(tmp_path / "mesh.obj")]) == 0
    result = json.loads(capfd.readouterr().out)
    assert [frame.get("between") for frame in result["frames"]] == [[4, 5], None, [5, 6]]
    assert len(list(cache.iterdir())) == 4
    assert len(list(tmp_path.glob("mesh_*.obj"))) == 3
    frames = sorted(saved_frames(out), key=lambda obj: obj.name)
    assert [obj["convwass_weights"][1] for obj in frames] == pytest.approx([4.25 / 8, 5 / 8, 5.5 / 8])
    places = [obj.location.x + obj.bound_box[0][0] for obj in frames]
    assert places == sorted(places)
    assert not any(obj.animation_data for obj in frames)


def test_help_names_every_option(capsys):
    assert cli.main(["morph", "--help"]) == 0
    text = capsys.readouterr().out
    for option in (
        "--layout",
        "--weights",
        "--at",
        "--sharpness",
        "--entropy-limit",
        "--level",
        "--scheduler",
        "--cache",
        "--frames-range",
        "--render",
        "--export",
        "--json",
    ):
        assert option in text
    assert "exit codes" in text


@pytest.mark.parametrize("command", program.COMMANDS)
def test_help_can_be_printed_in_any_encoding(capsys, command):
    assert cli.main([command.name, "--help"]) == 0
    assert capsys.readouterr().out.isascii()


@pytest.mark.parametrize(
    ("words", "name", "count"),
    [
        ("density m.ply --through A B --through C", "through", 3),
        ("density m.ply --propagate A=x --propagate x=B", "propagate", 2),
        ("density m.ply --distance-from 1 --distance-from 2", "distance_from", 2),
        ("softmap a.ply b.ply --pairs 1:2 --pairs 3:4", "pairs", 2),
        ("softmap a.ply b.ply --transfer weights --transfer keys", "transfer", 2),
        ("softmap a.ply b.ply --names A --names B", "names", 2),
        ("armature a.ply b.ply --pin A.head --pin B.tail", "pin", 2),
        ("armature a.ply b.ply --place A.head=0,0,0 --place B.tail=0,0,0", "place", 2),
        ("recolor a.png --palette b.png --palette c.png", "palette", 2),
    ],
)
def test_lists_may_be_given_in_parts(words, name, count):
    parser = program.command_line_parser("convwass")
    assert len(getattr(parser.parse_args(words.split()), name)) == count
    # The second command does not add to the list of the first one.
    assert len(getattr(parser.parse_args(words.split()), name)) == count


@pytest.mark.parametrize(
    "command", [command for command in program.COMMANDS if "in the project's folder" in command.description]
)
def test_examples_name_files_of_the_project(project, command):
    """Files without a folder are written by another example, or by this one."""
    block = command.description.partition("in the project's folder:\n")[2].partition("\n\n")[0]
    lines = [line.split() for line in block.splitlines()]
    assert lines
    for words in lines:
        assert program.command_line_parser("convwass").parse_args(words)
        named = [word for word in words if "/" in word and not word.endswith("/")]
        assert [word for word in named if not (project / word).is_file()] == []


def test_as_a_module(shapes, tmp_path, project):
    """Its folder for temporary files is empty afterwards."""
    out, temporary = tmp_path / "morph.blend", tmp_path / "temporary"
    temporary.mkdir()
    words = [*cube_and_ball(shapes), *QUICK, "--out", str(out), "--json"]
    done = subprocess.run(
        [sys.executable, "-m", "convwass_addon", *TRANSPORT, *words],
        cwd=project,
        env=os.environ | dict.fromkeys(("TMPDIR", "TEMP", "TMP"), str(temporary)),
        capture_output=True,
        text=True,
        check=True,
    )
    assert json.loads(done.stdout)["written"] == [str(out)]
    assert out.stat().st_size > 0
    assert not list(temporary.iterdir())


OPENED = """
import os, sys
from convwass_addon.console import open_streams
open_streams()
null = os.stat(os.devnull)
sys.exit(sum(2**number * os.path.samestat(os.fstat(number), null) for number in range(3)))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="closes streams by a POSIX shell")
@pytest.mark.parametrize(("closed", "opened"), [("<&-", 1), (">&-", 2), ("2>&-", 4), ("<&- >&- 2>&-", 7)])
def test_the_null_device_takes_the_places_of_closed_streams(tmp_path, project, closed, opened):
    for number in range(3):
        (tmp_path / str(number)).touch()
    others = " ".join(f"{way} {tmp_path / str(number)}" for number, way in enumerate(("<", ">", "2>")))
    command = shlex.join([sys.executable, "-c", OPENED])
    assert subprocess.run(f"{command} {others} {closed}", shell=True, cwd=project).returncode == opened


@pytest.mark.skipif(sys.platform == "win32", reason="closes streams by a POSIX shell")
def test_standard_streams_may_be_closed(shapes, tmp_path, project):
    out = tmp_path / "morph.blend"
    words = [*cube_and_ball(shapes), *QUICK, "--motion", "transport", "--out", str(out)]
    command = shlex.join([sys.executable, "-m", "convwass_addon", "morph", *words])
    subprocess.run(f"{command} <&- >&- 2>&-", shell=True, cwd=project, check=True)
    assert saved_frames(out)


@pytest.mark.skipif(sys.platform == "win32", reason="a process cannot interrupt itself alone")
@pytest.mark.parametrize(("ignored", "code"), [(False, -signal.SIGINT), (True, 0)])
def test_an_interrupt_while_blender_starts_ends_the_command(tmp_path, project, ignored, code):
    """Blender's start reports exceptions of its add-ons, and goes on; so does this one."""
    (tmp_path / "bpy.py").write_text(
        "import os, signal\ntry:\n    signal.raise_signal(signal.SIGINT)\n"
        "except BaseException:\n    pass\nos._exit(0)\n"
    )
    done = subprocess.run(
        [sys.executable, "-m", "convwass_addon", "--help"],
        cwd=project,
        env=os.environ | {"PYTHONPATH": str(tmp_path)},
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_IGN if ignored else signal.SIG_DFL),
        check=False,
    )
    assert done.returncode == code


INTERRUPTED = """
import runpy, signal, sys

class Finder:
    @staticmethod
    def find_spec(name, *_):
        if name == "convwass_addon.cli.program":
            signal.raise_signal(signal.SIGINT)

sys.meta_path.insert(0, Finder)
runpy.run_module("convwass_addon", run_name="__main__", alter_sys=True)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="a process cannot interrupt itself alone")
def test_an_interrupt_while_a_command_is_imported_is_told(project):
    done = subprocess.run(
        [sys.executable, "-c", INTERRUPTED, "--help"],
        cwd=project,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "convwass: interrupted\n")


def stored_settings(path):
    bpy.ops.wm.open_mainfile(filepath=str(path))
    return json.loads(baked_morph()["convwass_morph"])["settings"]


def cube_and_ball_of_blend(shapes):
    return [f"{shapes / 'all.blend'}:{name}" for name in ("Cube", "Ball")]


def test_guides_of_a_file_are_used_and_stored(shapes, tmp_path, monkeypatch):
    heard = []

    def transporting(inputs, blends, settings, control, **options):
        heard.append((settings.motion, list(inputs.guides)))
        return morph(inputs, blends, replace(settings, motion="transport"), control, **options)

    monkeypatch.setattr(job, "morph", transporting)
    out, file = tmp_path / "morph.blend", tmp_path / "guides.json"
    guides = [{"name": "corner", "points": {"Cube": 0, "Ball": 3}}]
    file.write_text(json.dumps(guides))
    words = [*cube_and_ball_of_blend(shapes), *QUICK, "--out", str(out), "--motion", "guided", "--guides", str(file)]
    assert cli.main(["morph", *words]) == 0
    assert heard == [("guided", [{0: 0, 1: 3}])]
    stored = stored_settings(out)
    (guide,) = stored["guides"]
    assert guide.pop("places").keys() == {"Cube", "Ball"}
    assert (stored["motion"], [guide]) == ("guided", guides)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('[{"points": {"Cube": 0, "Nobody": 3}}]', "refer to Nobody, which is not one of the shapes: Cube, Ball"),
        ('[{"points": {"Cube": 0, "Ball": 900}}]', "Guide 1 refers to vertex 900 of Ball, which has 42 vertices"),
        ('[{"points": {"Cube": 0}}]', "A guide connects points of at least two shapes"),
        ("[]", "contains no guides"),
        ("{", "guides.json: The guides cannot be read (Expecting"),
        ('{"name": "nose"}', "guides.json: The guides cannot be read (they are not a list)"),
        ('["nose"]', "guides.json: The guides cannot be read (an entry is not a guide with points)"),
        ('[{"points": {"Cube": "x"}}]', "cannot be read (Cube: x is no vertex number)"),
        (None, "guides.json: there is no such file; name groups, empties, bones or a JSON file"),
    ],
)
def test_guides_that_cannot_be_used_are_refused(shapes, tmp_path, capfd, text, message):
    out, file = tmp_path / "morph.blend", tmp_path / "guides.json"
    if text is not None:
        file.write_text(text)
    words = [*cube_and_ball_of_blend(shapes), *QUICK, "--out", str(out), "--motion", "guided"]
    assert cli.main(["morph", *words, "--guides", str(file)]) == 3
    assert message in capfd.readouterr().err
    assert not out.exists()


@pytest.mark.parametrize(
    ("limit", "message"),
    [
        ("-20", "No blend on this grid has an entropy as low as -20"),
        # Blends would have mass in fewer cells than they fill; at -8, the solver returned the whole grid.
        ("-7", "The entropy limit -7 is too low for these shapes: a solid of their volume has -"),
        ("-8", "The entropy limit -8 is too low for these shapes: a solid of their volume has -"),
    ],
)
def test_an_entropy_limit_that_no_blend_meets_is_refused(shapes, tmp_path, capfd, limit, message):
    out = tmp_path / "morph.blend"
    words = [*cube_and_ball(shapes), *QUICK, "--motion", "transport", "--entropy-limit", limit, "--out", str(out)]
    assert cli.main(["morph", *words]) == 3
    assert message in capfd.readouterr().err
    assert not out.exists()


@pytest.mark.parametrize("options", [["--motion", "transport"], ["--coherence", "0"]])
def test_guides_without_effect_are_reported(shapes, tmp_path, capfd, options):
    file = tmp_path / "guides.json"
    file.write_text('[{"points": {"Cube": 0, "Ball": 3}}]')
    words = [*cube_and_ball_of_blend(shapes), *QUICK, *options, "--out", str(tmp_path / "morph.blend")]
    assert cli.main(["morph", *words, "--guides", str(file)]) == 0
    assert "--guides has no effect" in capfd.readouterr().err


def test_flat_shapes_are_morphed_without_guides(tmp_path, capfd):
    for name in ("One", "Two"):
        bpy.ops.mesh.primitive_circle_add(vertices=12, fill_type="NGON")
        bpy.context.object.name = name
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "flat.blend"))
    words = [*(f"{tmp_path / 'flat.blend'}:{name}" for name in ("One", "Two")), "--resolution", "64", "--frames", "2"]
    words += ["--out", str(tmp_path / "morph.blend"), "--json"]
    capfd.readouterr()
    assert cli.main(["morph", *words, "--guides", "groups"]) == 0
    printed, said = capfd.readouterr()
    assert {frame["motion"]["reason"] for frame in json.loads(printed)["frames"]} == {"OUTLINES"}
    assert "do not support guides" in said
    assert stored_settings(tmp_path / "morph.blend")["guides"] == []
