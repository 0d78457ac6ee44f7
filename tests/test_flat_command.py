# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The command ``morph`` with flat shapes."""

from __future__ import annotations

import json

import bpy
import numpy as np
import pytest

from convwass_addon.bridge.flat.flat_imports import imported_shape
from convwass_addon.bridge.flat.flat_objects import flat_objects
from convwass_addon.bridge.morphs.stored import frame_objects
from convwass_addon.cli import main
from convwass_addon.errors import InputError

pytestmark = pytest.mark.usefixtures("empty_scene")

SVG = """<svg xmlns="http://www.w3.org/2000/svg" width="100" height="100">
<path fill="#d02010" d="M10 10 H60 V60 H10 Z"/><circle fill="#2030c0" cx="80" cy="80" r="15"/></svg>
"""


@pytest.fixture
def files(tmp_path):
    (tmp_path / "logo.svg").write_text(SVG, encoding="utf-8")
    (tmp_path / "broken.svg").write_text("<svg", encoding="utf-8")
    (tmp_path / "empty.svg").write_text("<svg xmlns='http://www.w3.org/2000/svg'/>", encoding="utf-8")
    (tmp_path / "broken.png").write_bytes(b"no picture")
    image = bpy.data.images.new("Disc", 64, 64)
    y, x = np.mgrid[:64, :64]
    white = (np.hypot(x - 32, y - 32) > 20).astype(np.float32)
    image.pixels.foreach_set(np.stack([white] * 3 + [np.ones_like(white)], axis=-1).ravel())
    image.filepath_raw, image.file_format = str(tmp_path / "disc.png"), "PNG"
    image.save()
    return tmp_path


def test_words_drawings_and_pictures_become_a_blend(files, capfd):
    target = files / "morph.blend"
    shapes = ["text:I", str(files / "logo.svg"), str(files / "disc.png")]
    options = ["--frames", "2", "--resolution", "128", "--scale", "equal-volume", "--out", str(target), "--json"]
    assert main(["morph", *shapes, *options]) == 0
    record = json.loads(capfd.readouterr().out)
    assert record["settings"]["resolution"] == 128
    assert len(record["frames"]) == 5
    bpy.ops.wm.open_mainfile(filepath=str(target))
    (collection,) = (one for one in bpy.data.collections if one.name.startswith("Morph"))
    assert collection.name == "Morph I to logo to disc"
    assert [obj.type for obj in frame_objects(collection)] == ["FONT", "CURVE", "CURVE", "CURVE", "CURVE"]


def test_meshes_are_exported(files, capsys):
    target = files / "shapes.obj"
    options = ["--weights", "1,1", "--resolution", "128", "--motion", "transport"]
    options += ["--out", str(files / "morph.blend"), "--export", str(target), "--flat-output", "mesh"]
    assert main(["morph", "text:I", "text:O", *options]) == 0
    capsys.readouterr()
    assert [path.name for path in files.glob("*.obj")] == ["shapes_0001.obj"]


def test_a_drawing_is_one_shape(files):
    (obj,) = imported_shape(str(files / "logo.svg"))
    assert (obj.type, obj.name) == ("CURVE", "logo")
    bpy.context.view_layer.update()
    (flat,) = flat_objects([obj], bpy.context.evaluated_depsgraph_get())
    assert len(flat.shape.rings) == 2
    assert len({tuple(color) for color in flat.shape.colors}) == 2
    assert len(bpy.data.objects) == 1


@pytest.mark.parametrize(
    ("shape", "message"),
    [
        ("text:", "needs some letters after the colon"),
        ("{files}/broken.svg", "broken.svg could not be read"),
        ("{files}/empty.svg", "empty.svg contains no curve"),
        ("{files}/broken.png", "broken.png could not be read; it is damaged"),
        ("{files}/missing.png", "does not exist"),
        ("{files}/shape.xyz", "does not exist"),
    ],
)
def test_unreadable_objects_are_reported(files, capsys, shape, message):
    text = shape.format(files=files)
    assert main(["morph", "text:A", text, "--out", str(files / "morph.blend")]) == 3
    assert message in capsys.readouterr().err
    assert not (files / "morph.blend").exists()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--output", "volume"], "Flat shapes have no volume"),
        (["--cache", "{files}/cache"], "cannot be cached or computed on other machines"),
        (
            ["--flat-output", "drawing", "--export", "{files}/a.obj"],
            "--export requires meshes; leave out --flat-output",
        ),
        (["--flat-output", "picture", "--output", "player"], "--output player requires meshes"),
        (["--flat-output", "curve", "--render"], "--render requires meshes"),
        (["--resolution", "12"], "Resolution 12 is too coarse for a blur of 1 cells; use at least 16, or less blur"),
        (["--resolution", "8", "--blur", "0.5"], "too coarse for a blur of 0.5 cells; use at least 12"),
    ],
)
def test_options_without_effect_are_refused(files, capsys, options, message):
    given = [option.format(files=files) for option in options]
    assert main(["morph", "text:A", "text:B", "--out", str(files / "morph.blend"), *given]) == 3
    assert message in capsys.readouterr().err


def test_a_text_together_with_a_solid_shape_needs_a_thickness(files):
    bpy.ops.mesh.primitive_cube_add()
    bpy.ops.wm.obj_export(filepath=str(files / "cube.obj"))
    shapes = ["text:A", str(files / "cube.obj"), "--out", str(files / "morph.blend")]
    assert main(["morph", *shapes]) == 3
    quick = ["--frames", "2", "--resolution", "32", "--motion", "transport"]
    assert main(["morph", *shapes, "--thickness", "0.4", *quick]) == 0


def test_a_text_in_a_blend_stays_a_text(files):
    bpy.ops.object.text_add(rotation=(0, 0, 1))
    bpy.context.object.data.body = "Hello"
    bpy.ops.wm.save_as_mainfile(filepath=str(files / "text.blend"), copy=True)
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    (obj,) = imported_shape(f"{files / 'text.blend'}:Text")
    assert (obj.type, obj.data.body) == ("FONT", "Hello")
    assert obj.rotation_euler.z == pytest.approx(1.0)
    with pytest.raises(InputError, match="has no object"):
        imported_shape(f"{files / 'text.blend'}:Nobody")
