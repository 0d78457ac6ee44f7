# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The command ``density``: files, output and exit codes."""

from __future__ import annotations

import json

import bpy
import numpy as np
import pytest

from convwass_addon import cli
from convwass_addon.applications import memory
from convwass_addon.bridge.densities.density_attributes import stored_frames
from convwass_addon.bridge.densities.density_player import density_value, played_densities
from convwass_addon.bridge.densities.density_store import stored_density
from convwass_addon.bridge.element_values import element_values
from convwass_addon.bridge.vertex_groups import read_group

pytestmark = [
    pytest.mark.usefixtures("empty_scene"),
    # Blender's own exporters under NumPy 2.5.
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
]


def add_group(obj, name, near, reach):
    """Paint the vertices near a point; return their number."""
    points = np.array([vertex.co for vertex in obj.data.vertices])
    painted = np.flatnonzero(np.linalg.norm(points - near, axis=1) < reach)
    obj.vertex_groups.new(name=name).add(painted.tolist(), 1.0, "REPLACE")
    return len(painted)


@pytest.fixture
def files(tmp_path, empty_scene):
    """A ball with painted groups, a lamp and a cube next to it in a .blend, and the ball alone as OBJ."""
    folder = tmp_path / "in"
    folder.mkdir()
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4, radius=1.0)
    ball = bpy.context.object
    ball.name = "Ball"
    bpy.ops.wm.obj_export(filepath=str(folder / "ball.obj"), export_selected_objects=True)
    # In the scene the ball has a radius of 2.
    ball.scale = (2, 2, 2)
    for name, near in {"East": (1, 0, 0), "North": (0, 1, 0), "Up, high": (0, 0, 1)}.items():
        assert add_group(ball, name, near, 0.35) > 15
    ball.vertex_groups.new(name="Nothing")
    bpy.ops.object.light_add()
    bpy.context.object.name = "Light"
    bpy.ops.mesh.primitive_cube_add(location=(9, 0, 0))
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "scene.blend"))
    return folder


def run(capfd, *words):
    """Run the command; return its exit code, standard output and standard error."""
    capfd.readouterr()
    code = cli.main(["density", *map(str, words)])
    return code, *capfd.readouterr()


def reopened(path):
    bpy.ops.wm.open_mainfile(filepath=str(path))
    return bpy.data.objects["Ball"]


def test_a_group_is_interpolated_to_another_in_the_users_scene(files, tmp_path, capfd):
    out = tmp_path / "flow.blend"
    words = [f"{files / 'scene.blend'}:Ball", "--from", "East", "--to", "North", "--steps", "4", "--out", out, "--json"]
    code, printed, said = run(capfd, *words)
    assert code == 0, said
    result = json.loads(printed)
    assert result["written"] == [str(out)]
    assert result["object"] == "Ball"
    assert result["settings"]["steps"] == 4
    assert [frame["key"] for frame in result["frames"]] == ["East", None, None, None, "North"]
    assert all(frame["converged"] for frame in result["frames"])
    ball = reopened(out)
    assert (bpy.context.scene.frame_start, bpy.context.scene.frame_end) == (1, 250)
    assert {obj.type for obj in bpy.data.objects} == {"MESH", "LIGHT"}
    assert played_densities(ball) == ["Density"]
    assert [material.name for material in ball.data.materials] == ["Density Heat Map"]
    known = stored_density(ball, "Density")
    assert known.inputs == ["East", "North"]
    assert known.settings.items() >= {**result["settings"], "trail": False, "frames": [1.0, 5.0]}.items()
    frames = stored_frames(ball)
    assert len(frames) == 5
    points = np.array([vertex.co for vertex in ball.data.vertices])
    middle = frames[2] @ points
    np.testing.assert_allclose(middle / np.linalg.norm(middle), np.array([1, 1, 0]) / np.sqrt(2), atol=0.03)
    seen = {}
    for frame in (1, 5):
        bpy.context.scene.frame_set(frame)
        values = ball.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.attributes["Density"].data
        read = element_values(values, "value")
        seen[frame] = read @ points
    assert seen[1][0] > 10 * abs(seen[1][1])
    assert seen[5][1] > 10 * abs(seen[5][0])


def test_a_path_of_unit_masses_on_a_file_without_groups(files, tmp_path, capfd):
    out = tmp_path / "path.blend"
    words = [
        files / "ball.obj",
        "--through",
        "vertex:0",
        "vertex:5,6",
        "vertex:0",
        "--steps",
        "2",
        "--entropy-limit",
        "off",
    ]
    code, printed, said = run(capfd, *words, "--out", out, "--name", "moss")
    assert code == 0, said
    assert printed.split() == [str(out)]
    bpy.ops.wm.open_mainfile(filepath=str(out))
    (obj,) = [obj for obj in bpy.data.objects if obj.type == "MESH"]
    assert played_densities(obj) == ["moss"]
    assert len(stored_frames(obj, "moss")) == 5
    assert (bpy.context.scene.frame_start, bpy.context.scene.frame_end) == (1, 5)


def test_an_eased_density_slows_down_at_every_group(files, tmp_path, capfd):
    words = [files / "ball.obj", "--through", "vertex:0", "vertex:5,6", "vertex:9", "--easing", "smooth"]
    code, _, said = run(capfd, *words, "--steps", "2", "--out", tmp_path / "path.blend")
    assert code == 0, said
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "path.blend"))
    (obj,) = [obj for obj in bpy.data.objects if obj.type == "MESH"]
    curve = density_value(obj).curve()
    assert [tuple(point.co) for point in curve.keyframe_points] == [(1.0, 0.0), (3.0, 0.5), (5.0, 1.0)]
    near = [curve.evaluate(frame) for frame in (2.9, 3.0, 3.1)]
    assert np.ptp(near) < 0.01, "it would be 0.05 at constant speed"


def test_a_blend_is_a_group(files, tmp_path, capfd):
    out = tmp_path / "blend.blend"
    words = [
        f"{files / 'scene.blend'}:Ball",
        "--blend",
        "Up, high=0.5,East=0.5",
        "--out",
        out,
        "--json",
        "--name",
        "Mix",
    ]
    code, printed, said = run(capfd, *words)
    assert code == 0, said
    result = json.loads(printed)
    assert result["frames"][0]["weights"] == [{"name": name, "weight": 0.5} for name in ("Up, high", "East")]
    assert result["scale"] > 1
    ball = reopened(out)
    weights = read_group(ball, "Mix")
    assert weights.max() == pytest.approx(1.0)
    points = np.array([vertex.co for vertex in ball.data.vertices])
    middle = weights @ points
    np.testing.assert_allclose(middle / np.linalg.norm(middle), np.array([1, 0, 1]) / np.sqrt(2), atol=0.05)


def test_distances_are_in_scene_units(files, capfd, tmp_path):
    """A quarter of the circumference of a ball of radius 2 is 3.14; a rotation is not quite the optimal transport."""
    source = f"{files / 'scene.blend'}:Ball"
    code, printed, said = run(capfd, source, "--measure", "East", "North")
    assert code == 0, said
    assert float(printed) == pytest.approx(np.pi, rel=0.06)
    code, plain, _ = run(capfd, source, "--measure", "East", "East", "--biased", "--json")
    assert code == 0
    result = json.loads(plain)
    assert not result["debiased"]
    assert abs(result["squared"]) > 0.01
    assert not list(tmp_path.glob("*.blend"))


@pytest.mark.parametrize("words", [["--measure", "East", "North"], ["--matrix"]])
def test_distances_have_the_requested_accuracy(files, capfd, words):
    found = {}
    for name, own in {"usual": [], "loose": ["--tolerance", "0.1"], "short": ["--max-iterations", "2"]}.items():
        code, printed, said = run(capfd, f"{files / 'scene.blend'}:Ball", *words, *own, "--json")
        assert code == 0, said
        found[name] = json.loads(printed)
    assert found["usual"]["converged"] and found["usual"]["marginal_error"] < 1e-5
    assert found["loose"]["converged"] and found["loose"]["marginal_error"] > 1e-5
    assert found["loose"]["iterations"] < found["usual"]["iterations"]
    assert not found["short"]["converged"]


def test_a_matrix_of_all_groups(files, capfd):
    source = f"{files / 'scene.blend'}:Ball"
    code, printed, said = run(capfd, source, "--matrix")
    assert code == 0
    assert "empty groups ignored: 1" in said
    assert len(printed.splitlines()) == 4
    _, printed, _ = run(capfd, source, "--matrix", "--json")
    result = json.loads(printed)
    lengths = np.array(result["lengths"])
    assert result["groups"] == ["East", "North", "Up, high"]
    np.testing.assert_allclose(lengths + np.eye(3) * np.pi, np.pi, rtol=0.06)


def test_distances_from_a_vertex(files, tmp_path, capfd):
    out = tmp_path / "far.blend"
    source = f"{files / 'scene.blend'}:Ball"
    code, printed, said = run(capfd, source, "--distance-from", "0", "--json", "--out", out)
    assert code == 0, said
    result = json.loads(printed)
    lengths = np.array(result["lengths"])
    assert lengths[0] == 0.0
    assert lengths.max() == lengths[result["furthest"]] == pytest.approx(2 * np.pi, rel=0.15)
    np.testing.assert_allclose(read_group(reopened(out), "Distance") * result["scale"], lengths, atol=1e-3)
    code, printed, said = run(capfd, source, "--distance-from", "0")
    assert code == 0, said
    assert f"vertices reached is vertex {result['furthest']}: " in printed


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (["{in}/scene.blend:Ball", "--from", "East", "--to", "West"], 3, "no vertex group West"),
        (["{in}/scene.blend:Ball", "--from", "East", "--to", "Nothing"], 3, "Nothing is empty"),
        (["{in}/scene.blend:Ball", "--from", "East", "--measure", "East", "North"], 3, "--from and --to"),
        (["{in}/scene.blend:Ball", "--to", "East"], 3, "--from and --to"),
        (["{in}/scene.blend:Ball", "--from", "East"], 2, "is required"),
        (["{in}/scene.blend:Ball", "--matrix", "--measure", "East", "North"], 2, "not allowed with"),
        (["{in}/scene.blend:Ball", "--measure", "East", "North", "--out", "a.blend"], 3, "leave out --out"),
        (["{in}/scene.blend:Ball", "--distance-from", "0", "--biased"], 3, "--biased"),
        (
            ["{in}/scene.blend:Ball", "--distance-from", "3", "9999"],
            3,
            "no vertex 9999; vertices are numbered from 0 to 641",
        ),
        (["{in}/scene.blend:Ball", "--distance-from", "0", "--tolerance", "0.1"], 3, "leave out --tolerance"),
        (["{in}/scene.blend:Ball", "--blend", "East"], 2, "such as A=0.3"),
        (["{in}/scene.blend:Ball", "--blend", "East=much"], 2, "such as A=0.3"),
        (["{in}/scene.blend:Ball", "--blend", "East=-1,North=1"], 3, "positive"),
        (
            ["{in}/scene.blend:Ball", "--blend", "East=1,North=1", "--name", "East"],
            3,
            "Ball already has a vertex group East that is no result",
        ),
        (
            ["{in}/scene.blend:Ball", "--distance-from", "0", "--name", "North", "--out", "{in}/far.blend"],
            3,
            "Ball already has a vertex group North that is no result",
        ),
        (["{in}/scene.blend:Ball", "--blend", "East=1"], 3, "at least two groups"),
        (["{in}/scene.blend:Ball", "--blend", "East=-1"], 3, "Weights must be zero or positive numbers"),
        (["{in}/scene.blend:Ball", "--from", "East", "--to", "North", "--entropy-limit", "-20"], 3, "as low as -20"),
        (["{in}/scene.blend:Ball", "--blend", "East=0"], 3, "All weights are zero"),
        (["{in}/scene.blend:Ball", "--through", "East"], 3, "at least two groups"),
        (["{in}/scene.blend:Ball", "--matrix", "--blur", "0.001"], 3, "finer than the mesh"),
        (["{in}/scene.blend:Ball", "--matrix", "--substeps", "0"], 3, "Substeps"),
        (["{in}/scene.blend:Ball", "--from", "East", "--to", "North", "--steps", "0"], 3, "Steps"),
        (["{in}/scene.blend:Ball", "--from", "East", "--to", "North", "--out", "{in}/no/a.blend"], 3, "does not exist"),
        (["{in}/scene.blend:Lamp", "--matrix"], 3, "no object Lamp"),
        (["{in}/scene.blend:Light", "--matrix"], 3, "not a mesh but of type light, which cannot"),
        (["{in}/scene.blend", "--matrix"], 3, "2 meshes; name one"),
        (["{in}/scene.blend:Cube", "--matrix"], 3, "at least two vertex groups with weights"),
        (["{in}/missing.blend:Ball", "--matrix"], 3, "does not exist"),
        (["{in}/broken.blend", "--matrix"], 3, "damaged"),
        (["{in}/ball.obj", "--measure", "vertex:1", "vertex:99999"], 3, "There is no vertex 99999"),
        (["{in}/ball.obj", "--measure", "vertex:1", "vertex:two"], 3, "no vertex group vertex:two"),
        (["{in}", "--matrix"], 3, "folder"),
    ],
)
def test_errors_have_codes_and_instructions(files, capfd, words, code, message):
    (files / "broken.blend").write_bytes(b"BLENDER nonsense")
    before = sorted(files.parent.rglob("*"))
    found, printed, said = run(capfd, *(word.replace("{in}", str(files)) for word in words))
    assert found == code
    assert message in said
    assert not printed
    assert sorted(files.parent.rglob("*")) == before


def test_frames_that_are_not_exact_are_counted(files, tmp_path, capfd):
    words = [f"{files / 'scene.blend'}:Ball", "--from", "East", "--to", "North", "--steps", "4"]
    code, _, said = run(capfd, *words, "--max-iterations", "1", "--out", tmp_path / "flow.blend")
    assert code == 0
    assert "3 of 5 frames are less exact than requested; try a larger --max-iterations" in said


def test_a_taken_name_is_refused_before_the_work(files, capfd):
    code, _, said = run(capfd, f"{files / 'scene.blend'}:Ball", "--from", "East", "--to", "North", "--name", "North")
    assert code == 3
    assert "already has a vertex group or an attribute North" in said
    assert "Moving the density" not in said


def test_too_much_memory_has_its_own_code(files, capfd, monkeypatch):
    monkeypatch.setattr(memory, "available_memory", lambda: 1_000_000)
    code, _, said = run(capfd, f"{files / 'scene.blend'}:Ball", "--matrix")
    assert code == 4
    assert "642 vertices" in said


def test_scripts_of_a_file_do_not_run(files, capfd):
    bpy.ops.wm.open_mainfile(filepath=str(files / "scene.blend"))
    text = bpy.data.texts.new("evil.py")
    text.write("import pathlib\npathlib.Path(r'" + str(files / "ran") + "').touch()\n")
    text.use_module = True
    bpy.ops.wm.save_mainfile()
    code, _, _ = run(capfd, f"{files / 'scene.blend'}:Ball", "--distance-from", "0")
    assert code == 0
    assert not (files / "ran").exists()


def test_help_names_every_option(capsys):
    assert cli.main(["density", "--help"]) == 0
    text = capsys.readouterr().out
    for option in ("--from", "--to", "--through", "--blend", "--measure", "--matrix", "--distance-from", "--json"):
        assert option in text
    assert "exit codes" in text


def test_groups_between_others_are_interpolated(files, tmp_path, capfd):
    out = tmp_path / "between.blend"
    edges = ["East=middle", "middle=North", "middle=Up, high"]
    code, printed, said = run(capfd, f"{files / 'scene.blend'}:Ball", "--propagate", *edges, "--out", out, "--json")
    assert code == 0, said
    result = json.loads(printed)
    assert list(result["scales"]) == ["middle"]
    assert [frame["key"] for frame in result["frames"]] == ["East", None, "North", "Up, high"]
    ball = reopened(out)
    weights = read_group(ball, "middle")
    points = np.array([vertex.co for vertex in ball.data.vertices])
    center = weights @ points
    # In the middle of the octant that the three span.
    np.testing.assert_allclose(center / np.linalg.norm(center), np.full(3, 3**-0.5), atol=0.05)
    assert weights.max() == pytest.approx(1.0, abs=1e-4)


def test_a_trail_stays_covered(files, tmp_path, capfd):
    out = tmp_path / "trail.blend"
    words = [
        f"{files / 'scene.blend'}:Ball",
        "--from",
        "East",
        "--to",
        "North",
        "--steps",
        "4",
        "--trail",
        "--out",
        out,
    ]
    assert run(capfd, *words)[0] == 0
    frames = stored_frames(reopened(out), "Density")
    assert (np.diff(frames, axis=0) >= 0.0).all()
    assert frames.max(axis=1) == pytest.approx(np.ones(5), abs=1e-3)
    covered = (frames > 0.5).sum(axis=1)
    assert covered[-1] > 1.8 * covered[0]


@pytest.mark.parametrize("edge", ["East", "East=", "East=x=North"])
def test_invalid_edges_are_refused(files, capfd, edge):
    code, _, said = run(capfd, files / "ball.obj", "--propagate", edge)
    assert code == 2
    assert "pair of places" in said


def test_skipped_modifiers_are_reported(files, tmp_path, capfd):
    bpy.ops.wm.open_mainfile(filepath=str(files / "scene.blend"))
    bpy.data.objects["Ball"].modifiers.new("Finer", "SUBSURF")
    bpy.ops.wm.save_mainfile()
    code, _, said = run(capfd, f"{files / 'scene.blend'}:Ball", "--measure", "East", "North")
    assert code == 0
    assert "ignored: Finer" in said
