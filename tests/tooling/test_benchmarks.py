# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The benchmark's meshes are what it says, and its table of distances gets printed; how fast it is, is not tested."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from benchmarks import __main__ as command_line, meshes, processes, table1

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
    read, voxelize, solve, surface, write, everything = map(float, rows[-1][1:7])
    assert min(read, voxelize, solve) > 0
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
    monkeypatch.setattr(command_line.morph, "main", lambda *options: started.append(("morph", *options)))
    monkeypatch.setattr(command_line.table1, "main", lambda *options: started.append(("table1", *options)))
    assert command_line.main([]) == 0
    assert started == [("morph", [64, 100], 24), ("table1", list(table1.SIZES), 5, 60.0)]
