# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Benchmarks measure what they say, and their tables get printed; how fast anything is, is not tested."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import time

import numpy as np
import pytest
from scipy.sparse.csgraph import dijkstra

from benchmarks import (
    __main__ as command_line,
    barycenter_peers,
    constants,
    geomloss_loop,
    measures,
    meshes,
    midpoint_cases,
    midpoints,
    peers,
    processes,
    quality,
    surface,
    table1,
)
from benchmarks.barycenter_cases import marginal_error
from benchmarks.clock import Clock
from benchmarks.rods import RADIUS, Legged
from convwass_addon.transport import Grid, Surface, barycenter
from tests.shapes import ball, joined, square, torus
from tools.environment import SetupError
from tools.peers import OPTIONAL, REQUIREMENTS, PeersEnvironment

PAPER_SIZES = (693, 1150, 1911, 3176, 5278, 8774, 14584)


def test_sizes_are_those_of_the_paper():
    assert table1.SIZES[: len(PAPER_SIZES)] == PAPER_SIZES


@pytest.mark.parametrize("make", [meshes.sphere, meshes.blob])
@pytest.mark.parametrize("count", PAPER_SIZES)
def test_meshes_have_the_count_and_are_closed_spheres(make, count):
    vertices, faces = make(count)
    tails, heads = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    forward = set(zip(tails.tolist(), heads.tolist(), strict=True))
    assert len(vertices) == len(np.unique(faces)) == count
    assert len(forward) == faces.size, "an edge belongs to two triangles that run the same way along it"
    assert {(head, tail) for tail, head in forward} == forward, "an edge belongs to one triangle only"
    assert count - faces.size // 2 + len(faces) == 2
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    assert np.einsum("ij,ij->i", a, np.cross(b, c)).min() > 0
    assert 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() == pytest.approx(1.0)


def test_blob_is_the_same_shape_at_every_size():
    coarse, fine = (meshes.blob(count)[0] for count in (1150, 14584))
    directions = [points / np.linalg.norm(points, axis=1, keepdims=True) for points in (coarse, fine)]
    nearest = (directions[0] @ directions[1].T).argmax(axis=1)
    np.testing.assert_allclose(
        np.linalg.norm(coarse, axis=1), np.linalg.norm(fine[nearest], axis=1), rtol=0.03, err_msg="radii differ"
    )
    assert np.ptp(np.linalg.norm(coarse, axis=1)) > 0.1


def test_edge_graph_has_every_edge_in_both_directions():
    vertices, faces = meshes.sphere(200)
    graph = meshes.edge_graph(vertices, faces)
    assert graph.nnz == faces.size
    np.testing.assert_array_equal(graph.toarray(), graph.T.toarray())
    tail, head = faces[17, :2]
    assert graph[tail, head] == pytest.approx(np.linalg.norm(vertices[tail] - vertices[head]))


def test_table_is_printed(project):
    command = [sys.executable, "-m", "benchmarks", "table1", "--sizes", "693", "--trials", "1"]
    printed = subprocess.run(command, cwd=project, capture_output=True, text=True, check=True).stdout
    rows = [line.split() for line in printed.splitlines() if line.startswith("     693")]
    times, costs, narrow, wide = rows
    assert min(map(float, times[1:])) > 0
    exact, pot, dense, entropic, debiased = map(float, costs[-5:])
    assert pot == pytest.approx(dense, rel=0.01)
    assert 0 < exact < dense
    assert 0 < debiased < entropic
    for row in (narrow, wide):
        circles, paths, _, divergence, value = map(float, row[4:9])
        assert circles < paths
        assert 0 < divergence < value


def test_morph_is_measured_by_stage(project):
    command = [sys.executable, "-m", "benchmarks", "morph", "--resolutions", "32", "--frames", "2"]
    printed = subprocess.run(command, cwd=project, capture_output=True, text=True, check=True).stdout
    rows = [line.split() for line in printed.splitlines() if line.startswith("    32")]
    assert len(rows) == 4  # three barycenters and the morph
    read, voxelize, solve, surface, write, everything, solve_wall, wall, workers = map(float, rows[-1][1:10])
    assert min(read, voxelize, solve) > 0
    assert 0 < solve_wall < wall
    assert workers >= 1
    assert all(8 <= float(row[-1]) < 1000 for row in rows[:3]), "bytes per cell: the shapes alone take 8"
    assert sum((read, voxelize, solve, surface, write)) <= everything + 0.05


def test_missing_pot_is_said_and_the_rest_runs(monkeypatch, capsys):
    tried = []
    monkeypatch.setattr(table1, "find_spec", lambda name: None)
    monkeypatch.setattr(table1, "_times", lambda sizes, trials, limit, peers: tried.append(peers) or [])
    monkeypatch.setattr(table1, "_print_costs", lambda rows: None)
    assert command_line.main(["table1", "--sizes", "10"]) == 0
    assert "POT is not installed, so the columns LP and POT stay empty" in capsys.readouterr().out
    assert tried == [("dense",)]


def test_what_a_late_case_has_reported_counts(tmp_path, monkeypatch):
    (tmp_path / "late.py").write_text("import time\nprint('{\"cpu\": 1}', flush=True)\ntime.sleep(60)\n")
    monkeypatch.setattr(processes, "PROJECT", tmp_path)
    assert processes.reports("late", "case", limit=5.0) == [{"cpu": 1}]


def test_no_name_means_every_benchmark(monkeypatch):
    started = []
    modules = (
        "morph",
        "flat",
        "quality",
        "coherence",
        "side_by_side",
        "table1",
        "surface",
        "skeleton",
        "correspondences",
        "recolor",
        "sphere",
        "peers",
        "constants",
    )
    for name in modules:
        module = getattr(command_line, name)
        monkeypatch.setattr(module, "main", lambda *options, name=name, **more: started.append((name, *options)))
    assert command_line.main([]) == 0
    assert started == [
        ("morph", [64, 100], 24),
        ("flat", [256, 512], 24, 256, 300.0, None),
        ("quality", 64, None),
        ("coherence", None, None, 100, 24),
        ("side_by_side", 100),
        ("table1", list(table1.SIZES), 5, 60.0),
        ("surface", list(surface.SIZES), 24),
        ("skeleton", None),
        ("correspondences", None, 1000),
        ("recolor",),
        ("sphere", [64, 128]),
        ("peers", [64, 100], 256, list(midpoints.SIZES), 300.0),
        ("constants", 72),
    ]


def test_constants_are_changed_one_at_a_time_and_are_as_before_in_the_end(capsys):
    before = [getattr(varied.module, varied.name) for varied in constants.VARIED]
    constants.main(16)
    rows = capsys.readouterr().out.splitlines()
    assert len(rows) == 3 + sum(len(varied.values) for varied in constants.VARIED)
    # What is changed is heeded: the step of the debiasing density decides how its rounds go.
    ends = {row.split(" | ")[0].strip("| "): row.split(" | ")[-1] for row in rows[2:]}
    assert ends["_DEBIAS_STEP 0.7: 0.5"].split(",")[0] != ends["as it is"].split(",")[0]
    assert [getattr(varied.module, varied.name) for varied in constants.VARIED] == before


def test_options_reach_the_benchmarks(monkeypatch, tmp_path):
    started = []
    monkeypatch.setattr(command_line.quality, "main", lambda *options, **more: started.append((*options, more)))
    monkeypatch.setattr(command_line.peers, "main", lambda *options: started.append(options))
    command_line.main(["quality", "--cells", "48", "--meshes", str(tmp_path), "--clean-only"])
    command_line.main(["peers", "--resolutions", "32,48", "--side", "64", "--sizes", "500", "--limit", "10"])
    assert started == [(48, tmp_path, {"clean_only": True, "held_back": False}), ([32, 48], 64, [500], 10.0)]


def test_pieces_bubbles_and_handles_are_counted():
    def counted(mesh):
        found = measures.topology(mesh)
        return found.pieces, found.crumbs, found.cavities, found.euler, found.handles

    assert counted(ball()) == (1, 0, 0, 2, 0)
    assert counted(torus()) == (1, 0, 0, 0, 1)
    assert counted(joined(ball(), torus(center=(4, 0, 0)))) == (2, 0, 0, 2, 1)
    assert counted(joined(ball(), ball(0.5).flipped())) == (1, 0, 1, 4, 0)
    assert counted(joined(ball(), ball(0.05, center=(2, 0, 0)))) == (2, 1, 0, 4, 0)
    with pytest.raises(ValueError, match="4 edges do not have two triangles"):
        measures.topology(square())


@pytest.mark.parametrize("dimensions", [2, 3])
@pytest.mark.parametrize("width", [2.0, 5.0])
def test_edge_width_of_a_known_ramp(dimensions, width):
    cells, radius = 64, 20.0
    distance = np.linalg.norm(np.moveaxis(np.indices((cells,) * dimensions), 0, -1) + 0.5 - cells / 2, axis=-1)
    density = np.clip(0.5 - (distance - radius) / width, 0.0, 1.0)
    # A linear ramp passes from 90 to 10 % on four fifths of its width.
    assert measures.edge_width(3.7 * density, float(density.sum())) == pytest.approx(0.8 * width, rel=0.08)


def test_overlap_of_two_balls_is_that_of_the_closed_form():
    shift, radius = 0.4, 0.9
    assert measures.overlap_with_ball(ball(points=8000)) == pytest.approx(1.0, abs=2e-3)
    assert measures.overlap_with_ball(ball(radius, points=8000)) == pytest.approx(radius**3, abs=2e-3)
    lens = np.pi * (2 - shift) ** 2 * (shift**2 + 4 * shift) / (12 * shift)
    found = measures.overlap_with_ball(ball(center=(0, shift, 0), points=8000))
    assert found == pytest.approx(lens / (8 / 3 * np.pi - lens), abs=3e-3)
    apart = measures.overlap_with_ball(joined(ball(radius, points=8000), ball(0.2, center=(3, 0, 0))))
    assert apart == pytest.approx(radius**3 / (1 + 0.2**3), abs=3e-3)


def test_ellipsoid_overlaps_with_itself():
    from benchmarks.blends import own_surface
    from benchmarks.quality_cases import _overlap, ellipsoid_pairs

    for ellipsoid in ellipsoid_pairs(48, 1)[1]:
        filled = ellipsoid.occupancy(48, 3)
        assert filled[0].sum() == filled[:, :, -1].sum() == 0, "it does not fit"
        assert _overlap(own_surface(filled), ellipsoid) > 0.985
        assert _overlap(own_surface(np.roll(filled, 1, axis=0)), ellipsoid) < 0.95


def test_surfaces_of_two_balls_are_as_far_apart_as_their_radii():
    found = measures.mean_surface_distance(ball(1.0, points=8000), ball(1.25, points=8000))
    assert found == pytest.approx(0.25, abs=2e-3)


def test_inside_is_what_a_mesh_encloses():
    points = np.random.default_rng(0).uniform(-2, 2, (500, 3))
    radii = np.linalg.norm(points, axis=1)
    clear = (abs(radii - 1) > 0.01) & (abs(radii - 0.5) > 0.01)
    found = measures.inside(points, joined(ball(points=4000), ball(0.5).flipped()))
    np.testing.assert_array_equal(found[clear], ((radii < 1) & (radii > 0.5))[clear])


def test_second_differences_see_bends_only():
    assert measures.largest_second_difference(np.arange(9.0) * 3 - 1)[0] == 0
    assert measures.largest_second_difference([0, 1, 2, 5, 8]) == (2, 2)
    size, where = measures.largest_second_difference([[0, 0], [1, 1], [5, 4], [9, 7]])
    assert (size, where) == (pytest.approx(13**0.5), 1)


def test_thin_is_what_a_ball_cannot_enter():
    filled = np.zeros((40, 40, 40), bool)
    filled[5:25, 5:25, 5:25] = True
    assert measures.thin_volume(filled, 1.0) <= 12 * 20 * 3, "only the edges of a cube are thin"
    rod = np.zeros_like(filled)
    rod[25:38, 14:16, 14:16] = True
    assert measures.thin_volume(filled | rod, 3.0) - measures.thin_volume(filled, 3.0) == pytest.approx(
        rod.sum(), abs=8
    )
    assert measures.thin_volume(rod, 3.0) == rod.sum()


def test_legs_are_where_their_points_are():
    first = Legged.at([32, 32, 32])
    second = Legged.at([30, 33, 32], [1.6, 1.0, 0.6])
    half = first.barycenter(second, 0.5)
    np.testing.assert_allclose(half.thin_points(), (first.thin_points() + second.thin_points()) / 2)
    for shape in (first, half, second):
        filled = shape.occupancy(64, 3)
        # Cells of which the surface cuts off but a corner may have been missed by all samples.
        assert (filled[tuple(shape.thin_points().astype(int).T)] > 0).mean() > 0.99
        ratio = filled.sum() / first.occupancy(64, 3).sum()
        assert ratio == pytest.approx(np.prod(shape.stretch), rel=0.01)
    assert first.thin_points()[:, 2].min() == pytest.approx(32 - 18 - RADIUS, abs=0.1)


def test_marginal_error_is_that_of_the_solver_and_notices_a_wrong_result():
    draw = np.random.default_rng(0)
    densities = draw.random((2, 12, 14, 16)) + 0.05
    domain = Grid(densities.shape[1:], 2.0)
    loose, tight = (barycenter(densities, [0.5, 0.5], domain, tolerance=level) for level in (1e-2, 1e-5))
    errors = [marginal_error(found.log_v, found.density, densities, domain) for found in (loose, tight)]
    assert errors[1] < 1e-5 < errors[0] < 1e-2
    assert marginal_error(tight.log_v, densities[0], densities, domain) > 0.1
    # Factors of the kernel and of the density mean nothing.
    same = marginal_error(tight.log_v, 5 * tight.density, 3 * densities, domain)
    assert same == pytest.approx(errors[1], rel=1e-6)


def test_frames_with_more_than_the_shapes_have_are_listed():
    def record(pieces, handles, crumbs=0, cavities=0):
        return {"pieces": pieces, "handles": handles, "crumbs": crumbs, "cavities": cavities}

    ends = [record(1, 0), record(2, 1)]
    frames = [record(1, 0), record(2, 1), record(3, 4, crumbs=1), record(1, 2)]
    assert quality._extra(ends, frames) == {"handles": {3: 3, 4: 1}, "pieces": {3: 1}, "crumbs": {3: 1}, "cavities": {}}


def test_pairs_of_a_folder_are_found_by_name(tmp_path):
    for name in ("spot_triangulated.obj", "bob_tri.obj", "spot_control_mesh.obj", "blub_quads.obj"):
        (tmp_path / name).touch()
    (found,) = quality._further_pairs(tmp_path)
    assert [quality._shown(found), *map(len, (quality._further_pairs(None),))] == ["spot - bob", 0]


def test_peers_are_asked_for_less_until_our_error_is_reached(monkeypatch):
    asked = []
    monkeypatch.setattr(peers, "measured", lambda *_, **__: {"error": 3 * asked[-1], "edge": 1.0})
    _, found = peers._to_tolerance(lambda threshold: asked.append(threshold) or {"cpu": 1.0}, "folder", 1.0)
    assert asked == pytest.approx([0.01, 0.01 * 0.8 / 3])
    assert found["error"] <= peers.TOLERANCE
    asked.clear()
    assert peers._to_tolerance(lambda threshold: asked.append(threshold) or {"failed": "*"}, "folder", 1.0)[1] == {}
    assert len(asked) == 1


def test_a_peer_gets_the_shapes_and_its_result_is_judged(tmp_path, capsys):
    distance = np.linalg.norm(np.moveaxis(np.indices((24, 24)), 0, -1) - 11.5, axis=-1)
    filled = np.stack([distance < 4.0, distance < 7.0]).astype(float)
    np.save(tmp_path / "filled.npy", filled.sum(axis=(1, 2)))
    np.save(tmp_path / "densities.npy", filled / filled.sum(axis=(1, 2), keepdims=True))
    # POT is among the test tools, so this Python will do.
    peers.Runner(sys.executable, 60.0)._peer(str(tmp_path), [24, 24], 2.0, "pot", False)
    row = capsys.readouterr().out.split()
    assert row[:5] == ["24", "x", "24", "2.00", "POT"]
    _, _, _, iterations, error, edge = map(float, row[5:])
    assert iterations % 10 == 0
    assert error <= peers.TOLERANCE
    assert 1 < edge < 10


def test_what_a_peer_cannot_do_is_a_row(capsys):
    used = {"cpu": 1.0, "wall": 1.0, "start": 0.0, "iterations": 10}
    peers._print([8, 8, 8], 1.0, "other", used, {"error": None, "edge": None})
    peers._print([8, 8, 8], 1.0, "other", {"failed": "ValueError: too narrow"}, {})
    first, second = capsys.readouterr().out.splitlines()
    assert first.endswith("NaN, and stops as if it had converged")
    assert second.endswith("other" + " " * 32 + "ValueError: too narrow")


def test_peers_need_a_network_the_first_time_and_say_so(project, tmp_path, monkeypatch, capfd):
    (tmp_path / REQUIREMENTS).parent.mkdir()
    for name in (REQUIREMENTS, OPTIONAL):
        shutil.copy(project / name, tmp_path / name)
    monkeypatch.setattr(peers, "PROJECT", tmp_path)
    # An environment takes seconds to make; pip fails in any.
    install = PeersEnvironment._run
    monkeypatch.setattr(PeersEnvironment, "program", sys.executable)
    monkeypatch.setattr(PeersEnvironment, "_run", lambda *step: None if step[1][2] == "venv" else install(*step))
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.setenv("PIP_FIND_LINKS", str(tmp_path))
    with pytest.raises(SystemExit, match=r"Installing the peers failed; .* it needs a network"):
        command_line.main(["peers", "--resolutions", "16"])
    assert "No matching distribution found" in capfd.readouterr().err
    assert not PeersEnvironment.of(tmp_path).is_installed()


@pytest.fixture
def peers_environment(tmp_path, monkeypatch):
    """One to be made in a folder with both lists of requirements, the steps of which are stood in for."""

    def run(self, command, problem):
        steps.append(command[2] if command[2] == "venv" else command[-1])
        if command[2] == "venv":
            self.program.parent.mkdir(parents=True)
            self.program.symlink_to(sys.executable)
            (self.folder / "pyvenv.cfg").write_text(f"home = {sys.base_prefix}\n", encoding="utf-8")
        if command[-1] in failing:
            raise SetupError(problem)

    steps, failing = [], []
    monkeypatch.setattr(PeersEnvironment, "_run", run)
    (tmp_path / REQUIREMENTS).parent.mkdir()
    for name in (REQUIREMENTS, OPTIONAL):
        (tmp_path / name).write_text("one\n", encoding="utf-8")
    return PeersEnvironment.of(tmp_path), steps, failing


@pytest.mark.parametrize("changed", [REQUIREMENTS, OPTIONAL])
def test_peers_are_installed_once_and_again_where_others_are_wanted(peers_environment, changed):
    environment, steps, _ = peers_environment
    environment.prepare_peers()
    environment.prepare_peers()
    assert steps == ["venv", REQUIREMENTS, OPTIONAL]
    (environment.project / changed).write_text("another\n", encoding="utf-8")
    environment.prepare_peers()
    assert steps == ["venv", REQUIREMENTS, OPTIONAL] * 2


def test_peers_do_without_what_pip_does_not_find_and_say_so(peers_environment, capsys):
    environment, steps, failing = peers_environment
    failing.append(OPTIONAL)
    environment.prepare_peers()
    said = capsys.readouterr().out
    assert f"Going on without what {OPTIONAL} lists" in said
    assert "To try again, delete .venv-peers" in said
    assert environment.is_installed()
    environment.prepare_peers()
    assert steps == ["venv", REQUIREMENTS, OPTIONAL], "it is tried once"


def test_a_peer_that_is_not_installed_is_a_row(tmp_path, project, monkeypatch, capsys):
    # None makes Python say that there is no such module, whether there is one or not.
    start = (
        "import runpy, sys; sys.modules['torch'] = None; sys.argv[0] = 'barycenter_peers'; "
        "runpy.run_module('benchmarks.barycenter_peers', run_name='__main__', alter_sys=True)"
    )
    options = f'{{"folder": {json.dumps(str(tmp_path))}, "sigma": 1.0, "threshold": 0.01, "seconds": 60}}'
    command = [sys.executable, "-c", start, "geomloss", options]
    printed = subprocess.run(command, cwd=project, capture_output=True, text=True, check=True).stdout
    monkeypatch.setattr(peers, "reports", lambda *_, **__: [json.loads(printed)])
    peers.Runner(sys.executable, 60.0)._geomloss("folder", [8, 8, 8], 1.0)
    assert capsys.readouterr().out.rstrip().endswith("GeomLoss' soft-min on volumes        not installed: torch")


def test_rows_of_geomloss_name_the_cube_that_it_ran_on(monkeypatch, capsys):
    used = {"cpu": 1.0, "wall": 1.0, "start": 0.0, "iterations": 65}
    monkeypatch.setattr(peers, "measured", lambda *_, **__: {"error": 0.009, "edge": 1.5})
    for cells in ([32, 32], [32, 32, 32]):
        monkeypatch.setattr(peers, "reports", lambda *_, cells=cells, **__: [{**used, "cells": cells}])
        peers.Runner(sys.executable, 60.0)._geomloss("folder", [24] * len(cells), 1.0)
    image, volume = capsys.readouterr().out.splitlines()
    assert image.split()[:6] == ["32", "x", "32", "1.00", "GeomLoss,", "debiased"]
    assert volume.startswith("  32 x 32 x 32  1.00  GeomLoss' soft-min on volumes ")


def test_shapes_are_in_the_middle_of_a_power_of_two_and_come_back():
    densities = np.random.default_rng(0).random((2, 5, 8, 3))
    assert geomloss_loop.in_cube(densities).shape == (2, 8, 8, 8)
    assert geomloss_loop.in_cube(densities[..., 0].repeat(2, axis=2)).shape == (2, 16, 16)
    cube = geomloss_loop.in_cube(densities)
    assert cube.sum() == pytest.approx(densities.sum())
    assert not cube[:, 0].any(), "three cells are added: one before, two behind"
    assert not cube[:, -2:].any()
    np.testing.assert_array_equal(geomloss_loop.out_of_cube(cube, (5, 8, 3)), densities)


class _Tensor(np.ndarray):
    """The little of PyTorch's that is needed."""

    def new_empty(self, shape):
        return np.empty(shape).view(_Tensor)

    def logsumexp(self, dim):
        return np.log(np.exp(self).sum(axis=dim))


@pytest.mark.parametrize("block", [1, 150, 1 << 20])
def test_lines_are_soft_mins_whatever_the_block(monkeypatch, block):
    monkeypatch.setattr(geomloss_loop, "_BLOCK", block)
    values = np.random.default_rng(0).normal(size=(11, 1, 7, 1)).view(_Tensor)
    x = np.linspace(0, 2, 7).view(_Tensor)
    values_j, x_i, x_j = map(geomloss_loop.Lines, (values, x.reshape(1, 7, 1, 1), x.reshape(1, 1, 7, 1)))
    found = (values_j - (x_i - x_j) ** 2).logsumexp(dim=2)
    kernel = np.exp(-((x[:, None] - x) ** 2))
    np.testing.assert_allclose(found[..., 0], np.log(np.exp(values[:, 0, :, 0]) @ kernel), atol=1e-12)


def _soft_min(eps, p, values):
    """Do what GeomLoss' soft-min does, on a few cells."""
    x = np.arange(values.shape[-1]) / values.shape[-1]
    cost = abs(x[:, None] - x) ** p / (p * eps)
    for axis in range(2, values.ndim):
        values = np.moveaxis(np.logaddexp.reduce(np.moveaxis(values, axis, -1)[..., None, :] - cost, axis=-1), -1, axis)
    return -eps * values


def _iteration(f_k, g_k, d_log, eps, p, ak_log, w_k):
    """Do what GeomLoss' does, from what is written about it: halfway to the new potentials, then the density."""
    bar_log = d_log - (w_k * _soft_min(eps, p, ak_log + g_k / eps) / eps).sum(1, keepdims=True)
    to_bar, to_inputs = _soft_min(eps, p, ak_log + g_k / eps), _soft_min(eps, p, bar_log + f_k / eps)
    f_k, g_k = (f_k + to_bar) / 2, (g_k + to_inputs) / 2
    bar_log = d_log - (w_k * _soft_min(eps, p, ak_log + g_k / eps) / eps).sum(1, keepdims=True)
    return f_k, g_k, (d_log + bar_log + _soft_min(eps, p, d_log) / eps) / 2, bar_log


@pytest.mark.parametrize(("dimensions", "threshold"), [(2, 0.1), (2, 1e-2), (2, 1e-5), (3, 1e-2)])
def test_scalings_from_potentials_of_geomloss_have_the_error_at_which_it_is_stopped(dimensions, threshold):
    side, sigma = 8, 1.3
    places = np.moveaxis(np.indices([side] * dimensions), 0, -1)
    squares = [((places - center) ** 2).sum(axis=-1) for center in (2.2, 4.6)]
    densities = np.exp([-squares[0] / 2.5, -squares[1] / 5.0])
    densities /= densities.sum(axis=tuple(range(1, 1 + dimensions)), keepdims=True)
    blur = sigma / side
    watch = geomloss_loop.Watch(_iteration, _soft_min, blur=blur, side=side, threshold=threshold, clock=Clock())
    state = (0 * densities[None], 0 * densities[None], np.zeros((1, 1, *[side] * dimensions)))
    with pytest.raises(geomloss_loop.Reached):
        for _ in range(2000):
            state = watch(*state, blur**2, 2, np.log(densities[None]), 0.5)[:3]
    domain = Grid(densities.shape[1:], sigma)
    error = marginal_error(watch.log_v, np.exp(watch.log_density), densities, domain)
    assert 0.2 * threshold < error <= 1.001 * threshold
    assert watch.iterations % 5 == 0
    # Densities between settle slowly, but it is the debiased one that this goes to.
    plain, debiased = (
        barycenter(densities, [0.5, 0.5], domain, sharpness=sharpness, tolerance=1e-7).density for sharpness in (0, 1)
    )
    apart = [_apart(np.exp(watch.log_density), other) for other in (plain, debiased)]
    assert apart[1] < 0.3 * apart[0]


def _apart(first, second):
    return abs(first / first.sum() - second / second.sum()).sum()


def test_geomloss_is_not_stopped_before_the_blur_that_was_asked_for():
    def returned(f_k, g_k, d_log, eps, p, ak_log, w_k):
        seen.append(eps)
        return f_k, g_k, d_log, np.zeros((1, 1, *ak_log.shape[2:]))

    seen = []
    watch = geomloss_loop.Watch(returned, _soft_min, blur=0.25, side=4, threshold=99.0, clock=Clock())
    for side, eps in ((2, 0.0625), (4, 0.25), (4, 0.09)):
        for _ in range(5):
            watch(*[np.zeros((1, 1, side, side))] * 3, eps, 2, np.zeros((1, 1, side, side)), 1.0)
    assert seen == [0.0625] * 5 + [0.25] * 5 + [0.09] * 5
    # Its schedule ends a step of 2^(1/10) above a blur of one cell.
    for _ in range(4):
        watch(*[np.zeros((1, 1, 4, 4))] * 3, 0.0625 * 2**0.2, 2, np.zeros((1, 1, 4, 4)), 1.0)
    with pytest.raises(geomloss_loop.Reached):
        watch(*[np.zeros((1, 1, 4, 4))] * 3, 0.0625, 2, np.zeros((1, 1, 4, 4)), 1.0)
    assert seen[-5:] == [0.0625] * 5


def test_midpoints_on_surfaces_are_a_table(capsys):
    # POT is among the test tools, so this Python will do.
    midpoints.main([300], sys.executable, 60.0, 0.01)
    own, pot = (line.split() for line in capsys.readouterr().out.splitlines() if line.startswith("     300"))
    assert own[:2] == ["300", "Convwass"]
    assert pot[:3] == ["300", "POT,", "kernel"]
    *_, iterations, own_error, own_peak = map(float, own[2:])
    assert own_error <= 0.01
    assert iterations >= 1
    assert own_peak > 10
    *_, iterations, error, peak, apart = map(float, pot[3:])
    assert iterations % 10 == 2, "it tests its error at the second iteration and every tenth after it"
    assert error <= 0.01
    assert peak > 10
    assert 0.005 < apart < 0.5, "other costs far away, but not another place"


@pytest.mark.parametrize("of_kernel", [True, False])
def test_pot_with_the_costs_of_our_kernel_finds_our_midpoint(tmp_path, of_kernel):
    count = 300
    own = midpoint_cases.own(str(tmp_path), count, 1e-4)
    surface = Surface(*meshes.blob(count))
    kernel = surface.apply(np.diag(1.0 / surface.weights))
    costs = -surface.gamma * np.log(kernel)
    # Areas differ by a factor of four: without them POT has another reference.
    np.save(tmp_path / "costs.npy", costs - surface.gamma * np.log(surface.weights) if of_kernel else costs)
    found = barycenter_peers.pot_dense(tmp_path, own["gamma"], 1e-4)
    assert max(own["error"], found["error"]) <= 1e-4
    assert found["program"] == "POT, kernel"
    apart = midpoints._apart(tmp_path)
    assert apart < 1e-3 if of_kernel else apart > 0.05


def test_errors_of_midpoints_are_those_of_plans(tmp_path):
    surface = Surface(*meshes.blob(200))
    masses = np.random.default_rng(0).random((2, 200))
    masses /= masses.sum(axis=1, keepdims=True)
    v = np.exp(np.random.default_rng(1).normal(size=(2, 200)))
    kernel = surface.weights[:, None] * surface.apply(np.diag(1.0 / surface.weights)) * surface.weights
    plans = [mass[:, None] / (kernel @ each)[:, None] * kernel * each for mass, each in zip(masses, v, strict=True)]
    for plan, mass in zip(plans, masses, strict=True):
        np.testing.assert_allclose(plan.sum(axis=1), mass)
    expected = abs(plans[0].sum(axis=0) - plans[1].sum(axis=0)).sum()
    assert midpoint_cases.marginals_apart(np.log(v), masses, surface) == pytest.approx(expected)


def test_costs_are_squared_distances_less_logarithms_of_areas(tmp_path):
    count = 600
    midpoint_cases.costs(str(tmp_path), count)
    surface = Surface(*meshes.blob(count))
    squares = np.load(tmp_path / "costs.npy") + surface.gamma * np.log(surface.weights)
    np.testing.assert_allclose(squares, squares.T, atol=1e-12)
    paths = dijkstra(meshes.edge_graph(surface.positions, surface.mesh.faces)) / surface.unit_length
    shares = np.sqrt(squares[paths > 0.2]) / paths[paths > 0.2]
    assert 0.7 < shares.min() <= shares.max() < 1.05
    assert 0.85 < np.median(shares) < 0.97, "paths along edges are 5 to 9 % too long"


def test_pot_goes_to_logarithms_where_float64_ends(tmp_path):
    own = midpoint_cases.own(str(tmp_path), 100, 0.01)
    midpoint_cases.costs(str(tmp_path), 100)
    found = barycenter_peers.pot_dense(tmp_path, own["gamma"] / 100, 0.5)
    assert found["program"] == "POT, log-sum-exp"
    assert np.isfinite(np.load(tmp_path / "barycenter.npy")).all()


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux limits the memory of a process")
def test_a_matrix_that_does_not_fit_is_a_row(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(midpoints, "_MEGABYTES", 1500)
    np.save(tmp_path / "masses.npy", np.full((2, 4), 0.25))
    costs = np.lib.format.open_memmap(tmp_path / "costs.npy", mode="w+", dtype=float, shape=(20_000, 20_000))
    del costs
    report = midpoints._pot(str(tmp_path), sys.executable, 60.0, 0.01, 0.01)
    midpoints._print(20_000, "POT", {"setup": 1.0, **report}, "")
    assert capsys.readouterr().out.split() == ["20000", "POT", "1.00", "does", "not", "fit", "in", "1.5", "GB"]


def test_clock_leaves_out_what_is_paused():
    clock = Clock()
    with clock.paused():
        time.sleep(0.2)
    assert clock.read()["wall"] < 0.15
    time.sleep(0.2)
    assert clock.read()["wall"] >= 0.2
