# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""No command overwrites one of its own inputs."""

from __future__ import annotations

import pytest

from convwass_addon import cli
from convwass_addon.cli.overwriting import refuse_overwriting
from convwass_addon.errors import InputError

pytestmark = pytest.mark.usefixtures("empty_scene")

MINE = b"Everything that the user has made."


@pytest.mark.parametrize(
    ("own", "words"),
    [
        ("own.blend", "morph own.blend:A own.blend:B --out own.blend"),
        ("own.blend", "morph own.blend:A own.blend:B --out own"),
        ("morph.blend", "morph morph.blend:A morph.blend:B"),
        ("own.blend", "morph own.blend:A own.blend:B --output shape-keys --out own.blend"),
        ("out.png", "morph text:A out.png --render --out out.blend"),
        ("own.glb", "morph own.glb own.glb --export own.glb"),
        ("own_0003.obj", "morph own_0003.obj text:A --frames 2 --export own.obj"),
        ("own_mesh.glb", "morph own_mesh.glb text:A --export own.json"),
        ("guides.json", "morph text:A text:B --guides guides.json --export guides.json"),
        ("out files/Morph/Morph.abc", "morph text:A out␣files/Morph/Morph.abc --output alembic --out out.blend"),
        ("own.blend", "density own.blend:A --from B --to C --out own.blend"),
        ("density.blend", "density density.blend:A --from B --to C"),
        ("own.blend", "density own.blend:A --distance-from 0 --out own.blend"),
        ("own.blend", "softmap other.blend:A own.blend:B --pairs 1:2 --out own.blend"),
        ("softmap.blend", "softmap softmap.blend:A --mirror --pairs 1:2"),
        ("own.obj", "softmap own.obj other.obj --pairs 1:2 --report own.obj"),
        ("own.blend", "armature body.blend own.blend:Rig --out own.blend"),
        ("armature.blend", "armature armature.blend rig.blend"),
        ("own.blend", "armature own.blend own.blend --report own.blend"),
        ("own.png", "recolor own.png --palette other.png --out own.png"),
        ("own.png", "recolor other.png --palette own.png --out own.png"),
        ("own.cube", "recolor other.png --palette own.cube --cube own.cube"),
        ("mask.png", "recolor other.png --palette own.png --mask mask.png --out mask.png"),
        ("own.npz", "reflect own.npz other.npz --out own.npz"),
        ("skies/sky.0002.exr", "sky skies/sky.0002.exr other.exr --steps 3 --out skies"),
    ],
)
def test_inputs_are_not_overwritten(tmp_path, monkeypatch, capfd, own, words):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / own
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(MINE)
    assert cli.main([word.replace("␣", " ") for word in words.split()]) == 3
    said = capfd.readouterr().err
    assert f"{path.name} is one of the inputs and would be overwritten" in said
    assert path.read_bytes() == MINE
    assert [other for other in tmp_path.rglob("*.*") if other != path] == []


@pytest.mark.parametrize("words", ["softmap a.obj b.obj --pairs 1:2", "armature a.obj b.obj"])
def test_a_report_does_not_overwrite_the_result(tmp_path, monkeypatch, capfd, words):
    monkeypatch.chdir(tmp_path)
    assert cli.main([*words.split(), "--out", "own", "--report", "./own.blend"]) == 3
    assert "--report would overwrite" in capfd.readouterr().err


@pytest.mark.parametrize("spelling", ["dots", "link", "hard link"])
def test_inputs_are_recognized_by_any_spelling(tmp_path, spelling):
    path, other = tmp_path / "own.blend", tmp_path / "other.blend"
    path.write_bytes(MINE)
    if spelling == "dots":
        other = tmp_path / ".." / tmp_path.name / "own.blend"
    elif spelling == "link":
        other.symlink_to(path)
    else:
        other.hardlink_to(path)
    with pytest.raises(InputError, match="would be overwritten"):
        refuse_overwriting([None, path], [None, other])


def test_other_files_may_be_replaced(tmp_path):
    path = tmp_path / "own.blend"
    path.write_bytes(MINE)
    refuse_overwriting([tmp_path / "missing.blend", path, None], [tmp_path / "new.blend", tmp_path / "missing.blend"])
