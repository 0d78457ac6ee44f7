# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Effect of recoloring on the pixels of images and on lookup tables."""

from __future__ import annotations

import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import map_coordinates

from convwass_addon.applications.palettes.distinct_colors import LEVELS
from convwass_addon.applications.palettes.interpolation import interpolated
from convwass_addon.applications.palettes.lab_colors import lab_of_linear, linear_of_srgb, srgb_of_linear
from convwass_addon.applications.palettes.lookup_table import LookupTable, lookup_table, read_cube, write_cube
from convwass_addon.applications.palettes.palette_settings import RecolorSettings
from convwass_addon.applications.palettes.pixel_blocks import recolored_blocks
from convwass_addon.applications.palettes.pixels import PixelFormat, image_palette
from convwass_addon.applications.palettes.recolor_job import Picture, map_steps, recolor_steps
from convwass_addon.applications.palettes.recoloring import recoloring
from convwass_addon.errors import Cancelled, InputError
from convwass_addon.progress import drained
from tests.controls import cancelled_control, recorded

from .palettes import cloud, picture_of

SRGB, SCENE = PixelFormat(), PixelFormat("linear", "associated", highest=np.inf)
BYTES = PixelFormat(levels=LEVELS)


@pytest.fixture(scope="module")
def source():
    return picture_of(cloud(1, (60.0, 5.0, -5.0), np.diag([7.0, 5.0, 4.0]), 12_000), 100)


@pytest.fixture(scope="module")
def target():
    return picture_of(cloud(2, (50.0, -10.0, 15.0), np.diag([5.0, 4.0, 6.0]), 5_000), 50)


def change_of(source, target, own=None, pixel_format=SRGB):
    return recoloring(
        image_palette(source, pixel_format), [image_palette(target, SRGB)], None, own or RecolorSettings()
    )


def recolored(pixels, change, pixel_format=SRGB, mask=None, workers=1):
    out = np.full_like(pixels, 7.0)
    reports = recolored_blocks(pixels, pixel_format, change, mask, out, workers=workers)
    shares = [report.fraction for report in reports]
    assert shares == sorted(shares) and shares[-1] == 1.0
    return out


def mean_lab(pixels):
    return lab_of_linear(linear_of_srgb(pixels[..., :3].reshape(-1, 3).T.astype(float))).mean(axis=1)


def test_the_mean_color_is_the_target_and_alpha_is_unchanged(source, target):
    translucent = source.copy()
    translucent[..., 3] = np.linspace(0.2, 1.0, 100)
    found = recolored(translucent, change_of(translucent, target))
    np.testing.assert_allclose(mean_lab(found), mean_lab(target), atol=0.5)
    np.testing.assert_array_equal(found[..., 3], translucent[..., 3])


def test_zero_strength_changes_no_bit(source, target):
    found = recolored(source, change_of(source, target, RecolorSettings(strength=0.0)))
    np.testing.assert_array_equal(found, source)


def test_half_strength_is_halfway(source, target):
    half = recolored(source, change_of(source, target, RecolorSettings(strength=0.5)))
    np.testing.assert_allclose(mean_lab(half), (mean_lab(source) + mean_lab(target)) / 2.0, atol=0.5)


def test_a_mask_protects_and_blends(source, target):
    change = change_of(source, target)
    mask = np.zeros(source.shape[:2], np.float32)
    mask[:, 50:] = 1.0
    mask[:, 49] = 0.5
    found, whole = recolored(source, change, mask=mask), recolored(source, change)
    np.testing.assert_array_equal(found[:, :49], source[:, :49])
    np.testing.assert_array_equal(found[:, 50:], whole[:, 50:])
    apart = np.abs(found[:, 49] - (source[:, 49] + whole[:, 49]) / 2.0)
    assert 0.0 < apart.max() < 0.02


def test_a_mask_chooses_the_palette(source):
    both = np.concatenate([source, picture_of(cloud(3, (70, 20, 0), np.eye(3) * 3, 12_000), 100)])
    mask = np.zeros(both.shape[:2], np.float32)
    mask[:120] = 1.0
    chosen, whole = image_palette(both, SRGB, mask), image_palette(source, SRGB)
    np.testing.assert_allclose(chosen.chroma, whole.chroma, atol=1e-15)


def test_nonfinite_pixels_are_unchanged(source, target):
    spoiled = source.copy()
    spoiled[3, 4] = [np.nan, 0.5, 0.5, 1.0]
    spoiled[5, 6] = [np.inf, 0.5, 0.5, 1.0]
    spoiled[7, 8, 3] = np.nan
    for edge_radius in (0, 2):
        found = recolored(spoiled, change_of(spoiled, target, RecolorSettings(edge_radius=edge_radius)))
        for place in ((3, 4), (5, 6), (7, 8)):
            np.testing.assert_array_equal(found[place], spoiled[place])
        assert np.isfinite(np.delete(found.reshape(-1, 4), [304, 506, 708], axis=0)).all()


def test_transparent_pixels_are_ignored_and_unchanged(source, target):
    part = source.copy()
    part[:30] = [1.0, 0.0, 0.0, 0.0]
    found = recolored(part, change_of(part, target))
    np.testing.assert_array_equal(found[:30], part[:30])
    np.testing.assert_allclose(mean_lab(found[30:]), mean_lab(target), atol=0.5)
    with pytest.raises(InputError, match="No pixel counts"):
        image_palette(np.zeros((2, 2, 4), np.float32), SRGB)


@pytest.mark.parametrize("size", [(1, 1), (1, 7), (5, 1)])
def test_tiny_images(size, target):
    tiny = np.full((*size, 4), 0.5, np.float32)
    tiny[..., 3] = 1.0
    found = recolored(tiny, change_of(tiny, target))
    np.testing.assert_allclose(mean_lab(found), mean_lab(target), atol=0.5)


def test_gray_gets_the_mean_hue(target):
    gray = np.repeat(np.linspace(0.3, 0.6, 4000, dtype=np.float32)[:, None], 4, axis=1).reshape(40, 100, 4)
    gray[..., 3] = 1.0
    np.testing.assert_allclose(mean_lab(recolored(gray, change_of(gray, target))), mean_lab(target), atol=0.5)


def test_scenes_keep_values_above_white(source, target):
    """A scene with the source's own palette, plus a few lamps."""
    scene = source.copy()
    scene[..., :3] = linear_of_srgb(source[..., :3])
    scene[::40, ::50, :3] *= 300.0
    scene[..., 3] = 0.5
    scene[..., :3] *= 0.5
    found = recolored(scene, change_of(scene, target, pixel_format=SCENE), SCENE)
    lamps = found[::40, ::50, :3] / 0.5
    assert lamps.max() > 10.0 and np.isfinite(found).all()
    rest = np.ones(scene.shape[:2], bool)
    rest[::40, ::50] = False
    means = [lab_of_linear(own.T.astype(float)).mean(axis=1) for own in (found[rest][:, :3] / 0.5,)]
    np.testing.assert_allclose(means[0], mean_lab(target), atol=1.5)
    same = recolored(scene, recoloring(*[image_palette(scene, SCENE)] * 1, [image_palette(scene, SCENE)]), SCENE)
    np.testing.assert_array_equal(same, scene)


def test_linear_pixels_of_other_primaries(source, target):
    """The same picture encoded with other primaries gives the same picture."""
    matrix = np.array([[1.6, -0.5, -0.1], [-0.1, 1.1, 0.0], [0.0, -0.1, 1.1]])
    wide = PixelFormat("linear", "straight", matrix)
    pixels = source.copy()
    pixels[..., :3] = linear_of_srgb(source[..., :3]) @ np.linalg.inv(matrix).T
    change = change_of(source, target)
    found, wanted = recolored(pixels, change, wide), recolored(source, change)
    np.testing.assert_allclose(found[..., :3] @ matrix.T, linear_of_srgb(wanted[..., :3]), atol=2e-5)


def test_blocks_and_threads_change_nothing(source, target):
    tall = np.tile(source, (40, 1, 1))
    for own in (RecolorSettings(), RecolorSettings(edge_radius=3)):
        change = change_of(source, target, own)
        found = recolored(tall, change, workers=3)
        np.testing.assert_array_equal(found[:100], recolored(tall[:200], change)[:100])
        middle = recolored(tall[1000:1800], change)
        np.testing.assert_allclose(found[1100:1700], middle[100:700], atol=1e-6)


def test_the_edge_aware_filter_smooths_uniform_regions(target):
    """Two uniform halves with grain: the amplified grain disappears, and the edge stays."""
    rng = np.random.default_rng(0)
    lab = np.zeros((3, 64 * 64))
    lab[0] = np.where(np.arange(64 * 64) % 64 < 32, 45.0, 65.0)
    lab[1:] = rng.normal(0, 1.0, (2, 64 * 64))
    pixels = picture_of(lab, 64)
    wide = picture_of(cloud(5, (55, 0, 0), np.diag([7.0, 6.0, 6.0])), 100)
    plain, filtered = (
        recolored(pixels, change_of(pixels, wide, RecolorSettings(edge_radius=radius))) for radius in (0, 4)
    )
    noise = [own[8:-8, 8:24, 1].std() for own in (pixels, plain, filtered)]
    assert noise[2] < 0.75 * noise[1]
    assert abs(noise[2] / noise[0] - 1.0) < 0.25
    steps = [own[8:-8, 40:56, 1].mean() - own[8:-8, 8:24, 1].mean() for own in (plain, filtered)]
    assert abs(steps[1] / steps[0] - 1.0) < 0.1


def test_the_filter_separates_colors_from_highlights(target):
    """White spots on a saturated ground, among darker ones: each kind changes as without the filter."""
    rng = np.random.default_rng(0)
    lab = np.zeros((3, 64, 64))
    lab[:] = np.array([45.0, 45.0, 30.0])[:, None, None]
    lab[:, rng.random((64, 64)) < 0.1] = np.array([25.0, 30.0, 15.0])[:, None]
    white = rng.random((64, 64)) < 0.03
    lab[:, white] = np.array([80.0, 0.0, 0.0])[:, None]
    pixels = picture_of(lab.reshape(3, -1), 64)
    plain, filtered = (
        recolored(pixels, change_of(pixels, target, RecolorSettings(edge_radius=radius))) for radius in (0, 6)
    )
    apart = np.abs(filtered - plain)[white].max(axis=1) * 255
    assert np.median(apart) < 6.0 and apart.max() < 20.0


@pytest.mark.parametrize("brightest", [1e3, 1e6])
def test_the_filter_tolerates_lamps(source, target, brightest):
    scene = source.copy()
    scene[..., :3] = linear_of_srgb(source[..., :3])
    scene[::9, ::7, :3] = brightest
    found = recolored(scene, change_of(scene, target, RecolorSettings(edge_radius=5), SCENE), SCENE)
    assert np.isfinite(found).all() and found[::9, ::7, :3].min() > 0.5 * brightest
    rest = (scene[..., 0] < brightest) & (scene[..., 0] > 0)
    assert found[rest].max() < 2.0


def test_large_images_need_little_additional_memory(source, target):
    change = change_of(source, target)
    large = np.ones((2048, 2048, 4), np.float32)
    large[..., :3] = np.resize(source[..., :3], (2048, 2048, 3))
    out = np.empty_like(large)
    tracemalloc.start()
    drained(recolored_blocks(large, SRGB, change, None, out, workers=2))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 0.7 * large.nbytes


def bytes_of(picture):
    """Return a picture with 8-bit values as floats, as Blender provides them."""
    return (np.round(picture * 255).astype(np.float32)) * np.float32(1 / 255)


@pytest.mark.parametrize("repeats", [1, 7])
@pytest.mark.parametrize("kind", ["map", "table"])
def test_bytes_change_like_floats(source, target, repeats, kind):
    """Pictures with few colors, each computed once, and with more distinct colors than half of the pixels."""
    pixels = bytes_of(np.tile(source, (repeats, 1, 1)))
    pixels[2:4, 5:50, 3] = 0.0
    pixels[6, :, 3] = bytes_of(np.linspace(0.1, 0.9, 100))
    change = change_of(source, target)
    if kind == "table":
        change = lookup_table(change, 17)
    found, wanted = recolored(pixels, change, BYTES, workers=2), recolored(pixels, change)
    # A sum of four products may be rounded in another order, where a vector register ends elsewhere.
    np.testing.assert_allclose(found, wanted, atol=1e-6)
    np.testing.assert_array_equal(found[2:4, 5:50], pixels[2:4, 5:50])


def test_every_byte_is_unchanged_by_the_identity(source, target):
    """All 16 million colors would take long: every level of each channel, and some mixtures."""
    levels = np.arange(256)
    ends = [np.stack(np.broadcast_arrays(*own)) for own in ((levels, 0, 255), (255, levels, 0), (0, 255, levels))]
    channels = np.concatenate([*ends, np.random.default_rng(0).integers(0, 256, (3, 3000))], axis=1)
    pixels = np.ones((3, channels.shape[1], 4), np.float32)
    pixels[..., :3] = channels.T.astype(np.float32) * np.float32(1 / 255)
    found = recolored(pixels, change_of(source, target, RecolorSettings(strength=0.0)), BYTES)
    np.testing.assert_array_equal(found, pixels)


@pytest.mark.parametrize("shape", [(7, 9), (5, 2, 4)])
def test_tables_are_interpolated_like_scipy(shape):
    rng = np.random.default_rng(0)
    tables = rng.random((2, *shape)).astype(np.float32)
    places = rng.uniform(-1.0, max(shape) + 1.0, (len(shape), 40_000))
    found = interpolated(tables, places)
    for table, own in zip(tables, found, strict=True):
        inside = np.clip(places, 0.0, np.array(shape)[:, None] - 1.0)
        np.testing.assert_allclose(own, map_coordinates(table, inside, order=1), atol=1e-6)


def test_tables_keep_values_above_white(source, target):
    """The identity on the unit cube changes nothing; other tables add the excess to the value at their border."""
    steps = np.linspace(0.0, 1.0, 5, dtype=np.float32)
    lattice = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1)
    identity = LookupTable(lattice, np.zeros(3), np.ones(3))
    inverse = LookupTable(1.0 - lattice, np.zeros(3), np.ones(3))
    scene = np.ones((2, 3, 4), np.float32)
    scene[0, :, :3] = [[0.2, 7.0, 300.0], [0.5, 0.5, 0.5], [-0.5, 0.1, 2.0]]
    straight = PixelFormat("linear", "straight", highest=np.inf)
    np.testing.assert_allclose(recolored(scene, identity, straight), scene, rtol=2e-5, atol=1e-5)
    found = recolored(scene, inverse, straight)
    rest = srgb_of_linear(np.array([7.0, 300.0])) - 1.0
    np.testing.assert_allclose(found[0, 0, 1:3], linear_of_srgb(rest), rtol=1e-4)


@pytest.mark.parametrize("pixel_format", [SRGB, SCENE])
def test_tables_are_applied_at_a_strength(pixel_format):
    """Straight in Lab, also where a mask sets the strength; colors outside the domain go as far."""
    pixels = np.random.default_rng(0).random((4, 50, 4)).astype(np.float32)
    pixels[..., 3] = 1.0
    colors = np.random.default_rng(1).random((3, 3, 3, 3)).astype(np.float32) * 0.4 + 0.3
    table = LookupTable(colors, np.full(3, 0.2), np.full(3, 0.9))
    half = replace(table, strength=0.5)
    middle, whole = recolored(pixels, half, pixel_format), recolored(pixels, table, pixel_format)
    first, last, own = (lab_of_linear(pixel_format.linear(each)) for each in (pixels, whole, middle))
    inside = ((pixel_format.linear(middle) > 1e-3) & (pixel_format.linear(middle) < 0.999)).all(axis=0)
    assert inside.mean() > 0.8
    np.testing.assert_allclose(own[:, inside], ((first + last) / 2.0)[:, inside], atol=2e-2)
    np.testing.assert_array_equal(recolored(pixels, replace(table, strength=0.0), pixel_format), pixels)
    mask = np.full(pixels.shape[:2], 0.5, np.float32)
    np.testing.assert_array_equal(recolored(pixels, table, pixel_format, mask), middle)


def test_a_single_pixel_is_not_changed_in_place(source, target):
    pixel = np.array([[[0.2, 0.1, 0.3, 0.5]]], np.float32)
    before = pixel.copy()
    recolored(pixel, change_of(source, target), SCENE)
    np.testing.assert_array_equal(pixel, before)


def test_steps_of_a_job(source, target):
    pictures = [Picture(source, SRGB), Picture(target, SRGB)]
    found = recorded(recolor_steps(pictures[0], pictures[1:], [1.0], RecolorSettings()))
    fractions = [step.fraction for step in found.reports]
    assert fractions == sorted(fractions) and fractions[-1] == pytest.approx(1.0)
    np.testing.assert_array_equal(found.result.pixels, recolored(source, change_of(source, target)))
    change = drained(map_steps(pictures[0], pictures[1:], [1.0], RecolorSettings()))
    np.testing.assert_array_equal(change.shifts(np.eye(3)), found.result.change.shifts(np.eye(3)))
    with pytest.raises(Cancelled):
        list(recolor_steps(pictures[0], pictures[1:], [1.0], RecolorSettings(), cancelled_control()))


@pytest.mark.parametrize(("size", "mean", "worst"), [(17, 1.5, 12.0), (65, 0.2, 4.0)])
def test_tables_agree_with_the_map(source, target, size, mean, worst):
    change = change_of(source, target)
    error = np.abs(recolored(source, lookup_table(change, size)) - recolored(source, change))[..., :3] * 255
    assert error.mean() < mean and error.max() < worst


def test_cubes_are_written_with_red_fastest_and_can_be_read_again(tmp_path):
    steps = np.linspace(0, 1, 3)
    colors = np.stack(np.meshgrid(steps, steps**2, 1 - steps, indexing="ij"), axis=-1).astype(np.float32)
    table = LookupTable(colors, np.zeros(3), np.ones(3))
    write_cube(table, tmp_path / "own.cube", 'a "title"\n')
    lines = (tmp_path / "own.cube").read_text().splitlines()
    assert lines[:2] == ['TITLE "a title"', "LUT_3D_SIZE 3"]
    assert lines[4:7] == ["0.000000 0.000000 1.000000", "0.500000 0.000000 1.000000", "1.000000 0.000000 1.000000"]
    found = read_cube(tmp_path / "own.cube")
    np.testing.assert_allclose(found.colors, colors, atol=1e-6)
    assert list(tmp_path.iterdir()) == [tmp_path / "own.cube"]


def test_cubes_of_other_programs(tmp_path):
    """Comments, blank lines, and the identity on another domain."""
    rows = [f"{2 * r} {2 * g} {2 * b}" for b in (0, 1) for g in (0, 1) for r in (0, 1)]
    head = ["# made elsewhere", "", 'TITLE "x"', "LUT_3D_SIZE 2", "DOMAIN_MIN 0 0 0", "DOMAIN_MAX 2.0 2.0 2.0"]
    (tmp_path / "a.cube").write_text("\r\n".join([*head, *rows, ""]))
    table = read_cube(tmp_path / "a.cube")
    colors = np.random.default_rng(0).random((3, 20)) * 2
    np.testing.assert_allclose(table.applied(colors), colors, atol=1e-6)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "LUT_3D_SIZE 2\n" + "0 0 0\n" * 7,
        "LUT_3D_SIZE 2\n" + "0 0 nan\n" * 8,
        "LUT_3D_SIZE 2\n" + "0 0 0 0\n" * 8,
        "LUT_3D_SIZE 2\n" + "0 0 zero\n" * 8,
        "LUT_3D_SIZE 2\n" + "0 0 1e30\n" * 8,
        "LUT_3D_SIZE -2\n" + "0 0 0\n" * 8,
        "LUT_3D_SIZE 1\n0 0 0\n",
        "LUT_3D_SIZE 9999\n0 0 0\n",
        "LUT_3D_SIZE 99999999999999\n0 0 0\n",
        "LUT_3D_SIZE ²\n0 0 0\n",
        "LUT_1D_SIZE 2\n0 0 0\n1 1 1\n",
        "LUT_3D_SIZE 2\nDOMAIN_MIN 1 1 1\nDOMAIN_MAX 1 1 1\n" + "0 0 0\n" * 8,
        b"\xff\xfe\x00",
    ],
)
def test_broken_cubes_are_refused(tmp_path, text):
    path = tmp_path / "broken.cube"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(InputError):
        read_cube(path)


def test_missing_cubes_are_refused(tmp_path):
    with pytest.raises(InputError, match="could not be read"):
        read_cube(tmp_path / "none.cube")


@pytest.mark.parametrize("size", [1, 130])
def test_sizes_of_tables_are_checked(source, target, size):
    with pytest.raises(InputError, match="along an edge"):
        lookup_table(change_of(source, target), size)
