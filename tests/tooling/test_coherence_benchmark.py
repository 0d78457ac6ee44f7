# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The coherence benchmark bakes by way of the application and prints what it finds."""

from __future__ import annotations

import json
from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks import (
    __main__ as command_line,
    clean_frames,
    coherence,
    coherence_cases,
    coherence_maps,
    coherence_sheets,
)
from benchmarks.coherence_cases import Bake, held, motions, passage, read_frames, settings_for
from benchmarks.coherence_pairs import Ends, pairs_named
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.geometry.closest_points import ClosestPointFinder
from tests.shapes import ball

FIGURES = {
    "pieces": 3, "torn": 0.25, "area": [0.9, 1.2], "reach": 0.8, "volume": 0.001, "largest": 1.7, "residual": None,
    "limb": {"length": 0.5, "tip": 0.1}, "cpu": 2.0, "wall": 3.0,
}  # fmt: skip


def test_a_pair_is_baked_measured_and_kept(tmp_path):
    found = passage("star to cross", "transport", cells=24, frames=4, keep=str(tmp_path / "frames"))
    assert found["pieces"] == 1
    assert found["volume"] < 0.1
    assert 0.7 < found["area"][0] <= found["area"][1] < 1.2
    assert found["limb"] is None
    assert [list(record["weights"]) for record in found["records"]] == [[0.75, 0.25], [0.5, 0.5], [0.25, 0.75]]
    meshes = read_frames(tmp_path / "frames.npz")
    assert len(meshes) == 5
    assert coherence_cases.Along.of(meshes, np.linspace(0, 1, 5)).area.min() == pytest.approx(found["area"][0])


def test_frames_torn_are_those_in_more_pieces_than_the_shapes_before_mending():
    shape = ball(radius=1.0)
    records = [{"found": {"pieces": pieces}} for pieces in (1, 2, 3)]
    bake = Bake([shape] * 5, np.linspace(0, 1, 5), records, 0.1, {"cpu": 1.0, "wall": 1.0})
    found = held(bake, Ends(shape, shape))
    assert found["pieces"] == 3
    assert found["torn"] == pytest.approx(2 / 3)


def test_motions_are_those_that_the_settings_offer():
    assert set(motions()) == {"automatic", "guided", "warp", "transport"}
    for motion in motions():
        assert settings_for(motion, 48) == MorphSettings(resolution=48, motion=motion)


def test_options_reach_the_benchmark(monkeypatch, tmp_path):
    started = []
    monkeypatch.setattr(coherence, "main", lambda *options, **more: started.append((options, more)))
    command_line.main(["coherence", "--pairs", "man walks,A to B", "--resolution", "32", "--held-back", "--json"])
    ((options, more),) = started
    assert options == (["man walks", "A to B"], None, 32, 24)
    assert more == {"held_back": True, "meshes": None, "as_json": True, "sheets": None, "maps": False}


def test_tables_are_printed_with_the_worst_beside_the_goal(monkeypatch, capsys, tmp_path):
    asked = []
    monkeypatch.setattr(coherence, "measured", lambda *case, **options: asked.append(options) or FIGURES)
    monkeypatch.setattr(coherence, "motions", lambda: ("automatic", "transport"))
    monkeypatch.setattr(coherence, "write_sheets", lambda files, folder: asked.append((files, folder)))
    names = ["man raises arm", "star to cross"]
    coherence.main(names, None, 32, 8, sheets=tmp_path)
    *cases, (files, folder) = asked
    assert [(case["pair"], case["motion"]) for case in cases] == [
        (n, m) for n in names for m in ("transport", "automatic")
    ]
    assert list(files) == names
    assert folder == tmp_path
    printed = capsys.readouterr().out
    assert "error of the limb's length" in printed
    assert "50.0 %" in printed
    coherence.main(names[:1], ["transport"], 32, 8, as_json=True)
    (line,) = capsys.readouterr().out.splitlines()
    assert json.loads(line)["build"] == "one build"


def test_a_pair_that_fails_says_why_and_the_rest_runs(monkeypatch, capsys):
    monkeypatch.setattr(coherence, "measured", lambda *case, **options: {"error": "no surface"})
    coherence.main(["man walks", "A to B"], ["transport"], 32, 8)
    assert capsys.readouterr().out.count("no surface") == 2


def test_unknown_pairs_and_motions_are_said(capsys):
    with pytest.raises(ValueError, match="no pair nobody; there are: man raises arm"):
        pairs_named(["nobody"], None)
    with pytest.raises(SystemExit, match="no pair nobody"):
        coherence.main(["nobody"], None, 32, 8)
    coherence.main(["A to B"], ["no motion"], 32, 8)
    assert "There is no motion no motion" in capsys.readouterr().err


def test_sheets_have_a_row_per_motion_that_is_there(monkeypatch, tmp_path, capsys):
    asked = []
    monkeypatch.setattr(coherence_sheets, "measured", lambda *case, **options: asked.append(options))
    (tmp_path / "one.npz").touch()
    files = {"transport": tmp_path / "one.npz", "warp": tmp_path / "missing.npz"}
    coherence_sheets.write_sheets({"man walks": files}, tmp_path / "new")
    (options,) = asked
    assert options["rows"] == [str(tmp_path / "one.npz")]
    assert options["target"].endswith("man_walks.png")


def test_a_sheet_is_rendered(monkeypatch, tmp_path):
    shown = []
    monkeypatch.setattr(
        coherence_sheets,
        "render_contact_sheet",
        lambda collection, target, width: shown.append(list(collection.objects)),
    )
    frames = {f"{kind}{i}": getattr(ball(points=50), kind) for i in range(9) for kind in ("vertices", "faces")}
    np.savez(tmp_path / "frames.npz", **frames)
    coherence_sheets.sheet([str(tmp_path / "frames.npz")] * 2, str(tmp_path / "sheet.png"))
    (objects,) = shown
    assert len(objects) == 2 * coherence_sheets.COLUMNS
    assert len({tuple(obj.location) for obj in objects}) == len(objects)


def test_clean_frames_are_told_with_the_worst_of_all(monkeypatch, capsys):
    figures = {
        "jumps": 2, "largest": 3.0, "changes": 1, "at_ends": 1.5, "lost_area": 0.06, "detail": 0.4, "angle": 12.0,
        "crossing": 0.0, "triangles": 9000, "cpu": 1.0, "wall": 2.0,
    }  # fmt: skip
    answers = [figures, {"error": "no surface"}, {**figures, "jumps": 0, "angle": 25.0}]
    asked = []

    def measured(*_case, motion, **_options):
        asked.append(motion)
        return answers[(len(asked) - 1) % 3]

    monkeypatch.setattr(clean_frames, "measured", measured)
    clean_frames.print_clean_frames(pairs_named(["man walks", "man to ogre", "A to B"], None), 32, 8, None)
    printed = capsys.readouterr().out
    assert "no surface" in printed
    assert asked == ["automatic"] * 3 + ["transport"] * 3
    lines = {line.split("  ")[0]: line.split()[-1] for line in printed.splitlines()[-8:]}
    assert (lines["jumps"], lines["angle"], lines["all jumps"]) == ("2", "12.0", "2")


class _Led:
    """A motion between one mesh and itself whose map shifts the numbers of the vertices."""

    def __init__(self, mesh, shift):
        order = np.roll(np.arange(len(mesh.vertices)), shift)
        images = ClosestPointFinder(mesh.corners).find(mesh.vertices[order])
        self.carriers = [SimpleNamespace(mesh=mesh)] * 2
        self.deformations = {key: SimpleNamespace(images=images) for key in ((0, 1), (1, 0))}


def test_tips_that_a_map_leads_to_another_one_are_astray():
    mesh = ball(points=40)
    tips = np.stack([mesh.vertices[[3, 20, 33]]] * 2)
    assert not coherence_maps.astray(_Led(mesh, 0), tips).any()
    assert coherence_maps.astray(_Led(mesh, 17), tips)[0, 1]


def test_maps_are_printed_with_what_is_wrong(monkeypatch, capsys):
    said = {"score": 0.9, "confidence": 0.95, "doubtful": 0.1, "round_trip_95": 0.2, "left_99": 0.01, "stretch": 0.3}
    answers = iter([{**said, "torn": 0.0, "folded": 0.0, "wrong": 2, "tips": 4, "cpu": 1.0}, {"error": "no map"}])
    monkeypatch.setattr(coherence_maps, "measured", lambda *case, **options: next(answers))
    coherence.main(["man walks", "A to B"], None, 32, 8, maps=True)
    printed = capsys.readouterr().out
    assert "2/4" in printed
    assert "no map" in printed
