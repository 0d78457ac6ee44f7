# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The soft map benchmark knows the truth of its pairs, and judges maps by it."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks import __main__ as command_line, correspondences, deformed_pairs, soft_map_cases
from benchmarks.deformed_pairs import ASSETS, PairKind, bent, deformed_pair, posed, scaled_end, twisted
from convwass_addon.geometry.mesh import TriangleMesh
from tests.shapes import ball, torus
from tools.environment import SetupError


def stretched(mesh):
    return mesh.vertices * (1.0, 1.0, 1.5)


@pytest.fixture(scope="module")
def pair():
    kind = PairKind("horse stretched", "horse", stretched, (3, 5), mirror=1)
    return deformed_pair(kind, ASSETS / "horse.ply", 300)


@pytest.fixture(scope="module")
def written(pair, tmp_path_factory):
    path = str(tmp_path_factory.mktemp("pairs") / "it.npz")
    np.savez(
        path,
        source=pair.source.vertices,
        source_faces=pair.source.faces,
        target=pair.target.vertices,
        target_faces=pair.target.faces,
        truth=pair.truth,
        landmarks=pair.landmarks,
        mirrored=pair.mirrored,
    )
    return path


def test_the_truth_is_where_the_deformation_takes_a_point(pair):
    ratio = pair.truth[:, 2] / pair.source.vertices[:, 2]
    high = np.abs(pair.source.vertices[:, 2]) > 0.2
    flat = pair.truth[:, :2] / pair.source.vertices[:, :2]
    wide = np.abs(pair.source.vertices[:, 0]) > 0.2
    # Up to the scale to unit area.
    assert np.median(ratio[high]) / np.median(flat[wide, 0]) == pytest.approx(1.5, rel=0.02)
    assert pair.source.area == pytest.approx(1.0, rel=0.15)


def test_meshes_have_nothing_in_common_but_the_surface(pair):
    assert 250 < len(pair.source.vertices) < 450
    assert 250 < len(pair.target.vertices) < 450
    image = pair.source.vertices * (1.0, 1.0, 1.5)
    apart = np.linalg.norm(pair.target.vertices[:, None] - image / np.sqrt(1.2), axis=2)
    assert (apart.min(axis=1) > 1e-4).mean() > 0.9


def test_landmarks_belong_together(pair):
    source, target = pair.landmarks.T
    missed = np.linalg.norm(pair.truth[source] - pair.target.vertices[target], axis=1)
    assert len(pair.landmarks) == 5
    assert missed.max() < 0.03


def test_the_truth_has_no_error_and_no_flips(pair):
    found = soft_map_cases.judged(pair, pair.truth)
    assert found["mean"] == pytest.approx(0.0, abs=1e-6)
    assert found["curve"] == [100.0] * len(soft_map_cases.RADII)
    assert found["flipped"] == 0.0


def test_the_mirrored_truth_is_all_flips(pair):
    found = soft_map_cases.judged(pair, pair.mirrored)
    assert found["flipped"] > 95.0
    assert found["mean"] > 8.0


def test_a_known_shift_is_measured():
    mesh = torus(0.4, 0.1, segments=(48, 24))
    mesh = TriangleMesh(mesh.vertices / np.sqrt(mesh.area), mesh.faces)
    around = np.roll(mesh.vertices.reshape(48, 24, 3), 1, axis=0).reshape(-1, 3)
    step = np.linalg.norm(around - mesh.vertices, axis=1).mean()
    pair = deformed_pairs.DeformedPair("ring", mesh, mesh, mesh.vertices, np.empty((0, 2), np.int64), None)
    found = soft_map_cases.judged(pair, around)
    assert found["mean"] == pytest.approx(100 * step, rel=0.02)
    assert "flipped" not in found
    half = np.roll(mesh.vertices.reshape(48, 24, 3), 24, axis=0).reshape(-1, 3)
    # Half way around, between half of the inmost circle and half of the middle one.
    far = soft_map_cases.judged(pair, half)["mean"]
    radii = np.linalg.norm(mesh.vertices[:, :2], axis=1)
    assert 100 * np.pi * radii.min() < far < 100 * np.pi * radii.mean()


def test_cases_read_what_was_written_and_report(written):
    near, filled = soft_map_cases.nearest(written), soft_map_cases.inpainted(written)
    assert near["mean"] < 8.0
    assert filled["mean"] < 8.0
    ours = soft_map_cases.ours(written, 5)
    assert ours["mean"] < min(near["mean"], 3.0)
    assert ours["seconds"] > 0
    assert ours["flipped"] < 2.0


def test_matches_of_other_programs_are_judged(pair, written, tmp_path):
    offsets = np.linalg.norm(pair.truth[:, None] - pair.target.vertices, axis=2)
    np.save(tmp_path / "match.npy", offsets.argmin(axis=1))
    found = soft_map_cases.matched(written, str(tmp_path / "match.npy"))
    assert found["mean"] == pytest.approx(100 * offsets.min(axis=1).mean(), rel=0.1)


def test_bending_keeps_the_axis_and_turns_the_ends():
    points = np.array([(x, y, 0.0) for x in np.linspace(-1, 1, 9) for y in (-0.1, 0.0, 0.1)])
    mesh = TriangleMesh.from_arrays(points, [(0, 1, 3), (24, 25, 26)])
    found = bent(mesh, 0, 1, np.pi / 2).vertices.reshape(9, 3, 3)
    middle = found[:, 1]
    np.testing.assert_allclose(np.linalg.norm(np.diff(middle, axis=0), axis=1), 0.25, rtol=0.01)
    ends = [found[place, 2] - found[place, 0] for place in (0, -1)]
    assert ends[0] @ ends[1] == pytest.approx(0.0, abs=1e-9), "a quarter of a turn in all"


def test_twisting_turns_one_end_against_the_other():
    mesh = ball(points=200)
    found = twisted(mesh, 2, 0.8).vertices
    np.testing.assert_allclose(found[:, 2], mesh.vertices[:, 2], atol=1e-9)
    top, bottom = mesh.vertices[:, 2].argsort()[[-3, 2]]
    turns = [np.arctan2(found[i, 1], found[i, 0]) - np.arctan2(*mesh.vertices[i, 1::-1]) for i in (top, bottom)]
    apart = mesh.vertices[top, 2] - mesh.vertices[bottom, 2]
    assert (turns[0] - turns[1]) % (2 * np.pi) == pytest.approx(0.8 * apart / np.ptp(mesh.vertices[:, 2]), abs=0.01)


def test_scaling_an_end_leaves_the_other():
    mesh = ball(points=400)
    found = scaled_end(mesh, 2, 0.3, 1.5).vertices
    low = mesh.vertices[:, 2] < 0.1
    np.testing.assert_array_equal(found[low], mesh.vertices[low])
    high = mesh.vertices[:, 2] > 0.95
    assert np.linalg.norm(found[high, :2], axis=1).mean() == pytest.approx(
        1.5 * np.linalg.norm(mesh.vertices[high, :2], axis=1).mean(), rel=0.1
    )


def test_posing_moves_ends_and_leaves_the_middle():
    mesh = TriangleMesh(ball(points=600).vertices * (3.0, 0.3, 0.3), ball(points=600).faces)
    found = posed(mesh, 2, 0.8, 0.7).vertices
    moved = np.linalg.norm(found - mesh.vertices, axis=1)
    assert not moved[np.abs(mesh.vertices[:, 0]) < 1.0].any()
    assert moved[np.abs(mesh.vertices[:, 0]) > 2.8].min() > 0.3


def test_every_pair_has_a_shape_or_says_that_it_has_none(monkeypatch, capsys):
    def refuse(self):
        raise SetupError("nothing to be had")

    monkeypatch.setattr(correspondences.PeersEnvironment, "prepare_peers", refuse)
    row = {"mean": 1.25, "curve": [10.0, 20.0, 30.0, 99.0, 100.0, 100.0], "flipped": 0.0, "seconds": 2.0}
    monkeypatch.setattr(
        correspondences,
        "measured",
        lambda module, case, **options: {"landmarks": [4], "floor": 1.4} if case == "make" else row,
    )
    correspondences.main(None, 300)
    output = capsys.readouterr().out
    assert "nothing to be had" in output
    assert "no file of blub" in output
    (line,) = (line for line in output.splitlines() if line.startswith("horse posed"))
    assert line.split() == [
        "horse",
        "posed",
        "4",
        "1.40",
        "1.25/",
        "99",
        "1.25/",
        "99",
        *"---",
        "1.25/",
        "99",
        "0.0",
        "2.0",
    ]
    assert output.splitlines()[-1].split()[0] == "ours"


def test_options_reach_the_benchmark(monkeypatch, tmp_path):
    started = []
    monkeypatch.setattr(command_line.correspondences, "main", lambda *options: started.append(options))
    command_line.main(["softmap"])
    command_line.main(["softmap", "--meshes", str(tmp_path), "--vertices", "500"])
    assert started == [(None, 1000), (tmp_path, 500)]
