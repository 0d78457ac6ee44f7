# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Gray images that become a sequence of pictures, by the operator and by the command."""

from __future__ import annotations

import hashlib
from pathlib import Path

import bpy
import numpy as np
import pytest

from convwass_addon.bridge.flat.gray_inputs import gray_inputs
from convwass_addon.bridge.flat.picture_bake import pictures_of
from convwass_addon.bridge.flat.picture_job import PictureJob
from convwass_addon.bridge.morphs.disk.disk_output import own_folder
from convwass_addon.bridge.morphs.disk.written_files import WRITTEN_KEY, drop_surplus
from convwass_addon.bridge.morphs.stored import frame_objects
from convwass_addon.cli import main
from convwass_addon.errors import ConvwassError, InputError
from tests.operators.morphs import baked_morph
from tests.pictures import pixels_in

pytestmark = pytest.mark.usefixtures("empty_scene")

PAPER, RED, BLUE = (1.0, 1.0, 0.9), (0.8, 0.0, 0.1), (0.0, 0.2, 0.6)


def spot(x, y, radius, ink, size=64, paper=PAPER):
    """A disc of ink on paper, (h, w, 4)."""
    rows, columns = np.mgrid[:size, :size] + 0.5
    full = np.clip(radius + 0.5 - np.hypot(columns - x, rows - y), 0.0, 1.0)[..., None]
    pixels = np.ones((size, size, 4), np.float32)
    pixels[..., :3] = np.asarray(paper) * (1 - full) + np.asarray(ink) * full
    return pixels


def picture(name, pixels, x=0.0):
    image = bpy.data.images.new(name, pixels.shape[1], pixels.shape[0], alpha=True)
    image.pixels.foreach_set(np.ascontiguousarray(pixels, np.float32).ravel())
    obj = bpy.data.objects.new(name, None)
    obj.empty_display_type, obj.data, obj.location.x = "IMAGE", image, x
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.update()
    return obj


def bake(place, *objects, **options):
    settings = {"frames": 4, "flat_resolution": 128, "flat_output": "PICTURE", "folder": str(place)}
    settings["inputs"] = ",".join(obj.name for obj in objects)
    return bpy.ops.convwass.bake_morph(motion="TRANSPORT", **{**settings, **options})


def inked(pixels):
    """Share of the picture that is not paper, in the middle of the two."""
    return float((np.abs(pixels[..., :3] - pixels[0, 0, :3]).max(axis=2) > 0.3).mean())


def test_an_image_is_read_with_its_grays_its_ink_and_its_ground():
    gray = spot(32, 32, 20, RED)
    gray[:, :, :3] = np.where(
        np.arange(64)[:, None, None] < 32, gray[:, :, :3], 0.5 * gray[:, :, :3] + 0.5 * np.array(PAPER)
    )
    obj = picture("Half", gray)
    obj.empty_display_size = 2.0
    bpy.context.view_layer.update()
    (found,) = gray_inputs([obj], bpy.context.evaluated_depsgraph_get())
    np.testing.assert_allclose(found.ground, [*PAPER, 1.0], atol=0.01)
    assert found.shape.pixel == pytest.approx(2.0 / 64)
    values = found.shape.values
    np.testing.assert_allclose([values[32, 20], values[32, 44], values[2, 2]], [1.0, 0.5, 0.0], atol=0.01)
    # Ink is the same in both halves.
    np.testing.assert_allclose(found.shape.colors[32, [20, 44], :3], [RED, RED], atol=0.02)


@pytest.mark.parametrize("grays", ["IMAGES", "THRESHOLD"])
def test_pictures_travel_and_mix_their_colors(tmp_path, grays):
    first, last = picture("First", spot(32, 32, 14, RED)), picture("Last", spot(32, 32, 14, BLUE), x=5.0)
    assert bake(tmp_path, first, last, grays=grays) == {"FINISHED"}
    files = sorted(tmp_path.glob("*/*.png"))
    assert [path.name[-8:] for path in files] == [f"000{number}.png" for number in range(1, 6)]
    middle = pixels_in(files[2])
    center = middle[middle.shape[0] // 2, middle.shape[1] // 2, :3]
    np.testing.assert_allclose(center, 0.5 * (np.array(RED) + np.array(BLUE)), atol=0.02)
    np.testing.assert_allclose(middle[0, 0], [*PAPER, 1.0], atol=0.01)
    # A disc keeps its form and size.
    assert inked(middle) == pytest.approx(inked(pixels_in(files[0])), rel=0.03)
    (plane,) = frame_objects(baked_morph())
    (material,) = plane.data.materials
    (node,) = (node for node in material.node_tree.nodes if node.type == "TEX_IMAGE")
    assert (node.image.source, node.image_user.frame_duration, node.image_user.use_auto_refresh) == (
        "SEQUENCE",
        5,
        True,
    )
    assert plane.dimensions.x / plane.dimensions.y == pytest.approx(middle.shape[1] / middle.shape[0], rel=1e-3)


def test_pictures_that_are_held_are_copied(tmp_path):
    objects = picture("First", spot(32, 32, 10, RED)), picture("Last", spot(32, 32, 14, RED))
    bake(tmp_path, *objects, frame_step=2)
    files = sorted(tmp_path.glob("*/*.png"))
    assert len(files) == 5
    assert files[0].read_bytes() == files[1].read_bytes() != files[2].read_bytes()


def test_pictures_before_frame_0_are_one_sequence(tmp_path):
    objects = picture("First", spot(32, 32, 10, RED)), picture("Last", spot(32, 32, 14, BLUE))
    bake(tmp_path, *objects, start="CUSTOM", frame_start=-3)
    (plane,) = frame_objects(baked_morph())
    for frame, number in ((-9, 0), (-3, 0), (-2, 1), (0, 3), (1, 4), (9, 4)):
        bpy.context.scene.frame_set(frame)
        shown = plane.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.materials[0]
        (node,) = (node for node in shown.node_tree.nodes if node.type == "TEX_IMAGE")
        path = Path(node.image.filepath_from_user(image_user=node.image_user))
        assert path.stem.endswith(f"_000{number}")
        assert path.is_file()


def test_pictures_past_frame_9999_are_one_sequence(tmp_path):
    """All numbers have five digits then; brackets in the name of the folder are no pattern."""
    folder = tmp_path / "pictures [x]"
    objects = picture("First", spot(32, 32, 10, RED)), picture("Last", spot(32, 32, 14, BLUE))
    bake(folder, *objects, frames=2, start="CUSTOM", frame_start=9998)
    morph = the_morph()
    found = pictures_of(morph)
    assert [path.stem[-6:] for path in found] == ["_09998", "_09999", "_10000"]
    assert found == sorted(folder.rglob("*.png"))
    (plane,) = frame_objects(morph)
    (node,) = (node for node in plane.data.materials[0].node_tree.nodes if node.type == "TEX_IMAGE")
    assert bpy.path.abspath(node.image.filepath) == str(found[0])
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    assert pictures_of(the_morph()) == found


def the_morph():
    (morph,) = (collection for collection in bpy.data.collections if collection.name.startswith("Morph"))
    return morph


def contents(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_pictures_that_are_made_again_take_the_place_of_the_old_ones_at_the_end(tmp_path):
    objects = picture("First", spot(32, 32, 10, RED)), picture("Last", spot(32, 32, 14, RED))
    bake(tmp_path, *objects)
    before = contents(tmp_path)
    assert len(before) == 5
    objects[0].data.pixels.foreach_set(spot(32, 32, 10, BLUE).ravel())
    for _ in range(2):
        assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
        after = contents(tmp_path)
        assert after.keys() == before.keys() and after != before
    (plane,) = frame_objects(baked_morph())
    (node,) = (node for node in plane.data.materials[0].node_tree.nodes if node.type == "TEX_IMAGE")
    shown = pixels_in(bpy.path.abspath(node.image.filepath))
    np.testing.assert_allclose(shown[shown.shape[0] // 2, shown.shape[1] // 2, :3], BLUE, atol=0.02)


def test_pictures_of_another_file_are_kept(tmp_path):
    objects = picture("First", spot(32, 32, 10, RED)), picture("Last", spot(32, 32, 14, RED))
    other = tmp_path / "Morph_First_to_Last" / "Morph_First_to_Last_0001.png"
    other.parent.mkdir()
    other.write_bytes(b"shown by another file")
    bake(tmp_path, *objects)
    assert other.read_bytes() == b"shown by another file"
    assert {path.parent.name for path in pictures_of(the_morph())} == {"Morph_First_to_Last_001"}


def test_a_bake_that_is_stopped_leaves_the_pictures_of_the_morph_that_it_would_replace(tmp_path, monkeypatch):
    objects = picture("First", spot(32, 32, 10, RED)), picture("Last", spot(32, 32, 14, RED))
    bake(tmp_path, *objects)
    bpy.ops.convwass.rebake_morph()
    before = contents(tmp_path)

    def fail(job, hide_inputs):
        raise ConvwassError("Stopped")

    monkeypatch.setattr(PictureJob, "finish", fail)
    with pytest.raises(RuntimeError, match="Stopped"):
        bpy.ops.convwass.rebake_morph()
    assert contents(tmp_path) == before


def test_a_shorter_bake_removes_only_the_pictures_of_a_longer_one(tmp_path):
    objects = picture("First", spot(32, 32, 10, RED)), picture("Last", spot(32, 32, 14, RED))
    bake(tmp_path, *objects, frames=7)
    (morph,) = (own for own in bpy.data.collections if own.name.startswith("Morph"))
    files = pictures_of(morph)
    assert len(files) == 8
    files[5].write_bytes(b"painted over by somebody")
    foreign = [files[0].with_name(name) for name in ("notes.txt", f"{files[0].stem[:-5]}_0099.png", "other_0007.png")]
    for path in foreign:
        path.write_bytes(b"not of any bake")
    bake(tmp_path, *objects, frames=3, replaces=morph.name)
    assert sorted(files[0].parent.iterdir()) == sorted([*files[:4], files[5], *foreign])
    # What is noted is that of the new bake: the next one knows its own files.
    bake(tmp_path, *objects, frames=2, replaces=morph.name)
    assert sorted(files[0].parent.iterdir()) == sorted([*files[:3], files[5], *foreign])


def test_a_morph_that_is_renamed_during_its_bake_is_the_one_that_is_replaced(tmp_path, monkeypatch):
    objects = picture("First", spot(32, 32, 10, RED)), picture("Last", spot(32, 32, 14, RED))
    bake(tmp_path, *objects, frames=7)
    morph, finish = the_morph(), PictureJob.finish
    files = pictures_of(morph)

    def renamed(job, hide_inputs):
        morph.name = "Mine"
        return finish(job, hide_inputs)

    monkeypatch.setattr(PictureJob, "finish", renamed)
    bake(tmp_path, *objects, frames=3, replaces=morph.name)
    assert pictures_of(morph) == files[:4] == sorted(files[0].parent.iterdir())


@pytest.mark.parametrize(
    "noted", ["", "[1]", "{", '{"../x.png": 3}', 7, '{"../keep.png": "DIGEST", "keep.png": "DIGEST"}']
)
def test_stored_file_names_are_not_trusted(noted, tmp_path):
    outside, inside = tmp_path / "keep.png", tmp_path / "Morph" / "keep.png"
    inside.parent.mkdir()
    for path in (outside, inside):
        path.write_bytes(b"mine")
    morph = bpy.data.collections.new("Morph")
    digest = hashlib.sha256(b"mine").hexdigest()[:32]
    morph[WRITTEN_KEY] = noted.replace("DIGEST", digest) if isinstance(noted, str) else noted
    drop_surplus(morph, inside.parent, "Morph", [])
    assert outside.exists() and inside.exists()


@pytest.mark.parametrize(
    ("change", "options", "message"),
    [
        (lambda obj: setattr(obj, "scale", (1, 2, 1)), {}, "scaled unevenly"),
        (lambda obj: obj.data.pixels.foreach_set(np.ones(4 * 64 * 64, np.float32)), {}, "is uniform"),
        (lambda obj: bpy.ops.object.text_add(), {"layout": "TRIANGLE", "inputs": "First,Last,Text"}, "another layout"),
        (lambda obj: None, {"folder": "//convwass"}, "Save the file first"),
        (lambda obj: None, {"words": "LETTERS"}, "has no letters"),
    ],
)
def test_invalid_pictures_are_reported_and_leave_nothing_behind(tmp_path, change, options, message):
    objects = picture("First", spot(32, 32, 10, RED)), picture("Last", spot(32, 32, 14, RED))
    change(objects[1])
    bpy.context.view_layer.update()
    with pytest.raises(RuntimeError, match=message):
        bake(tmp_path, *objects, **options)
    assert not [collection for collection in bpy.data.collections if collection.name.startswith("Morph")]
    assert not list(tmp_path.glob("*/*.png"))


def test_an_image_of_one_tone_is_refused():
    with pytest.raises(InputError, match="is uniform"):
        gray_inputs([picture("Gray", np.full((8, 8, 4), 0.5))], bpy.context.evaluated_depsgraph_get())


def test_the_command_writes_pictures_next_to_the_blend(tmp_path, capsys):
    sources = []
    for name, ink in (("first", RED), ("last", BLUE)):
        image = picture(name, spot(32, 32, 14, ink)).data
        image.filepath_raw, image.file_format = str(tmp_path / f"{name}.png"), "PNG"
        image.save()
        sources.append(str(tmp_path / f"{name}.png"))
    target = tmp_path / "out.blend"
    options = ["--frames", "2", "--resolution", "128", "--flat-output", "picture", "--out", str(target)]
    assert main(["morph", *sources, *options, "--grays", "threshold"]) == 0
    capsys.readouterr()
    files = sorted((tmp_path / "out files").glob("*/*.png"))
    assert len(files) == 3
    bpy.ops.wm.open_mainfile(filepath=str(target))
    (image,) = (image for image in bpy.data.images if image.source == "SEQUENCE")
    assert bpy.path.abspath(image.filepath) == str(files[0])
    # Baked again in the window, they stay there.
    assert own_folder("//out files", the_morph()) == files[0].parent
