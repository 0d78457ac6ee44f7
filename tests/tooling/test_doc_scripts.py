# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The scripts in docs/ run, and their output is correct."""

from __future__ import annotations

import re
import runpy
import sys
from pathlib import Path

import bpy
import numpy as np
import pytest

import convwass_addon
from convwass_addon.applications.palettes.lab_colors import lab_of_linear, linear_of_lab, linear_of_srgb, srgb_of_linear
from convwass_addon.applications.palettes.lookup_table import read_cube
from convwass_addon.bridge.objects import triangle_mesh
from convwass_addon.bridge.vertex_groups import read_group
from tests.pictures import blue_image, mean_lab, pixels_in, red_image

# Blender's own exporters under NumPy 2.5.
pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")


@pytest.fixture
def run_script(project, tmp_path, monkeypatch, capfd):
    """Run a script of docs/scripts in a temporary folder; return its output."""
    monkeypatch.chdir(tmp_path)
    # The tests have already registered the add-on.
    for name in ("register", "unregister"):
        monkeypatch.setattr(convwass_addon, name, lambda: None)

    def run(name: str, *words: object) -> str:
        script = project / "docs" / "scripts" / name
        monkeypatch.setattr(sys, "argv", [str(script), *map(str, words)])
        capfd.readouterr()
        runpy.run_path(str(script), run_name="__main__")
        return capfd.readouterr().out

    return run


def numbers_of(line: str) -> list[float]:
    return [float(number) for number in re.findall(r"-?\d+\.\d+", line)]


def test_every_script_is_listed_and_tested(project):
    scripts = {path.name for path in (project / "docs" / "scripts").glob("*.py")}
    told = set(re.findall(r"\((\w+\.py)\)", (project / "docs/scripts/README.md").read_text(encoding="utf-8")))
    tested = set(re.findall(r'run_script\("(\w+\.py)"', Path(__file__).read_text(encoding="utf-8")))
    assert scripts == told == tested


def test_barycenters_of_arrays_are_those_of_gaussians(run_script, tmp_path):
    """Between Gaussians of widths s and t are Gaussians whose centers and widths change linearly."""
    first, *lines = run_script("barycenter_arrays.py", "--out", "blends.npz").splitlines()
    assert numbers_of(first)[0] == pytest.approx(np.sqrt(0.4**2 + 0.3**2 + 2 * 0.03**2), rel=1e-3)
    for line in lines:
        share, x, y, width = numbers_of(line)
        found = (x, y, width)
        assert found == pytest.approx((0.3 + 0.4 * share, 0.3 + 0.3 * share, 0.05 + 0.03 * share), abs=2e-4)
        assert "converged True" in line
    assert len(lines) == 5
    assert np.load(tmp_path / "blends.npz")["blends"].shape == (5, 64, 64)


def test_the_ring_is_periodic(run_script):
    """Between eleven at night and three in the morning is one in the morning, not one in the afternoon."""
    first, *lines = run_script("ring_domain.py").splitlines()
    assert numbers_of(first)[0] == pytest.approx(4.0, rel=1e-3)
    found = [numbers_of(line)[1] for line in lines]
    assert found == pytest.approx([0.0, 1.0, 2.0], abs=5e-3)
    assert all("converged True" in line for line in lines)


@pytest.mark.usefixtures("empty_scene")
def test_meshes_are_morphed_into_files(run_script, tmp_path):
    # Without limbs, which would be guided.
    shapes = [tmp_path / "ball.ply", tmp_path / "egg.ply"]
    for shape, height in zip(shapes, (1.0, 1.5), strict=True):
        bpy.ops.mesh.primitive_uv_sphere_add(scale=(1.0, 1.0, height))
        bpy.ops.wm.ply_export(filepath=str(shape), forward_axis="Y", up_axis="Z", export_selected_objects=True)
    run_script("morph_meshes.py", *shapes, "--frames", 3, "--resolution", 24, "--out", "frames")
    written = sorted((tmp_path / "frames").iterdir())
    assert [path.name for path in written] == [f"frame_{number:04d}.ply" for number in range(1, 5)]
    volumes = []
    for path in written:
        bpy.ops.wm.ply_import(filepath=str(path), forward_axis="Y", up_axis="Z")
        volumes.append(triangle_mesh(bpy.context.object, bpy.context.evaluated_depsgraph_get()).volume)
    # The second shape is scaled to the volume of the first, and the frames between have it, too.
    assert volumes == pytest.approx([volumes[0]] * 4, rel=0.02)
    assert volumes[0] > 0


@pytest.mark.usefixtures("empty_scene")
def test_a_density_flows_from_vertex_to_vertex(run_script, tmp_path):
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4)
    points = np.array([vertex.co for vertex in bpy.context.object.data.vertices])
    bpy.ops.wm.obj_export(filepath=str(tmp_path / "ball.obj"))
    east, north = (int((points @ axis).argmax()) for axis in np.eye(3)[:2])
    run_script("density_flow.py", "ball.obj", "--start", east, "--end", north, "--steps", 2, "--out", "flow.blend")
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "flow.blend"))
    (obj,) = bpy.data.objects
    places = np.array([obj.matrix_world @ vertex.co for vertex in obj.data.vertices])
    wanted = [places[east], places[east] + places[north], places[north]]
    for number, direction in enumerate(wanted):
        weights = read_group(obj, f"Flow {number:02d}")
        assert weights.max() == 1.0
        middle = weights @ places
        assert middle @ direction / np.linalg.norm(middle) / np.linalg.norm(direction) > np.cos(np.radians(3.0))


def blob(name: str, subdivisions: int) -> bpy.types.Object:
    """Add a long ball without symmetries."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=subdivisions)
    obj = bpy.context.object
    obj.name = name
    for vertex in obj.data.vertices:
        x, y, z = vertex.co
        vertex.co = x + 0.3 * (1.6 * z) ** 2, 0.7 * y, 1.6 * z
    return obj


def nearest(obj: bpy.types.Object, place: tuple[float, float, float]) -> int:
    return int(np.linalg.norm(np.array([vertex.co for vertex in obj.data.vertices]) - place, axis=1).argmin())


@pytest.mark.usefixtures("empty_scene")
def test_weights_go_from_file_to_file(run_script, tmp_path):
    places = [(0.77, 0, 1.6), (0.77, 0, -1.6), (-1, 0, 0), (1, 0, 0), (0, 0.7, 0), (0, -0.7, 0)]
    marks = []
    for name, subdivisions in (("Fox", 4), ("Dog", 3)):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        obj = blob(name, subdivisions)
        if name == "Fox":
            upper = [vertex.index for vertex in obj.data.vertices if vertex.co.z > 0]
            obj.vertex_groups.new(name="Top").add(upper, 1.0, "REPLACE")
        marks.append([nearest(obj, place) for place in places])
        bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / f"{name}.blend"))
    pairs = [f"{first}:{second}" for first, second in zip(*marks, strict=True)]
    words = ("Fox.blend", "Fox", "Dog.blend", "Dog", "--pairs", *pairs, "--vertices", 200, "--out", "rigged.blend")
    out = run_script("transfer_weights.py", *words)
    assert "Top: " in out
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "rigged.blend"))
    assert "Fox" not in bpy.data.objects
    dog = bpy.data.objects["Dog"]
    weights, heights = read_group(dog, "Top"), np.array([vertex.co.z for vertex in dog.data.vertices])
    assert weights[heights > 0.3].min() > 0.9
    assert weights[heights < -0.3].max() < 0.1


@pytest.mark.usefixtures("empty_scene")
def test_a_folder_is_graded(run_script, tmp_path):
    (tmp_path / "photos").mkdir()
    for image, path in ((red_image(), "photos/red.png"), (blue_image(), "blue.png")):
        image.file_format = "PNG"
        image.save(filepath=str(tmp_path / path))
    out = run_script("grade_folder.py", "photos", "--palette", "blue.png", "--out", "graded")
    assert out.count("marginal error") == 1
    wanted, found, before = (
        mean_lab(pixels_in(tmp_path / name)) for name in ("blue.png", "graded/red.png", "photos/red.png")
    )
    assert np.linalg.norm(found - wanted) < 1.5 < np.linalg.norm(before - wanted)
    # The table maps the old mean to the new one.
    table = read_cube(tmp_path / "graded" / "red.cube")
    moved = lab_of_linear(linear_of_srgb(table.applied(srgb_of_linear(linear_of_lab(before[:, None])))))[:, 0]
    assert np.linalg.norm(moved - wanted) < 3.0
