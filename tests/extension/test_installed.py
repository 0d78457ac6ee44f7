# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension as users get it: installed from the zip into a clean profile, and completely used.

Offline, in a read-only folder, by a user whose name has spaces and letters of three scripts.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest


@pytest.fixture(scope="module")
def work(profile) -> Path:
    """Folder of the user's files."""
    return profile.folder.parent / "Eigene Dateien ✓"


@pytest.fixture(scope="module")
def seen(profile, zip_file, work) -> dict:
    """The report of a session with the installed extension."""
    return profile.run(
        ("offered", []),
        ("install", [str(zip_file)]),
        ("lock", [str(profile.extension)]),
        ("clear", []),
        ("offered", []),
        ("polls", []),
        ("languages", []),
        ("presets", []),
        ("manual_page", ["bpy.ops.convwass.bake_morph"]),
        ("coarsen", []),
        ("make", [str(work)]),
        ("large_products", []),
        ("figures", []),
        ("leftovers", []),
        ("polls", []),
        ("panels", []),
        ("module_files", []),
        ("refused", []),
    )


@pytest.fixture(scope="module")
def removed(seen, profile, work) -> dict:
    """The report of the next session, which disabled, enabled and removed the extension with its work open."""
    return profile.run(
        ("offered", []),
        ("open_file", [str(work)]),
        ("figures", []),
        ("disable", []),
        ("offered", []),
        ("figures", []),
        ("enable", []),
        ("remove", []),
        ("offered", []),
        ("figures", []),
    )


@pytest.fixture(scope="module")
def without(seen, stranger, work) -> dict:
    """The report of a user who opened the file and never had the extension."""
    return stranger.run(("open_file", [str(work)]), ("offered", []), ("figures", []), ("leftovers", []))


def assert_same(one: dict, other: dict) -> None:
    """Compare the figures of a file in two sessions."""
    assert one.keys() == other.keys()
    for frame, own in one.items():
        assert own.keys() == other[frame].keys()
        for name, numbers in own.items():
            np.testing.assert_allclose(other[frame][name], numbers, rtol=2e-3, atol=0.01, err_msg=f"{frame}: {name}")


def changing(figures: dict) -> set[str]:
    """Names of everything that is not the same at all frames."""
    first, *others = figures.values()
    return {name for name, numbers in first.items() if any(other[name] != numbers for other in others)}


def test_installing_enables_it(seen):
    assert seen["offered"] == []
    assert seen["install"] == [True, True]
    assert "CONVWASS_OT_bake_morph" in seen["offered 2"]


def test_it_runs_from_where_it_was_installed(seen, profile, request):
    own = [Path(file) for file in seen["module_files"] if "convwass_addon" in file]
    assert len(own) > 100
    assert all(file.is_relative_to(profile.extension) for file in own)
    if request.config.getoption("--zip", None):
        others = [Path(file) for file in seen["module_files"] if "convwass_addon" not in file]
        assert len(others) >= 5
        assert all(file.is_relative_to(profile.folder) for file in others)


def test_everything_can_be_made(seen):
    assert set(map(tuple, seen["make"].values())) == {("FINISHED",)}
    assert len(seen["make"]) >= 20


def test_no_large_product_is_computed_by_numpy(seen):
    """The speed does not depend on NumPy's BLAS, because Blender's own builds of NumPy may lack one."""
    assert seen["large_products"] == []


def test_nothing_uses_the_network_or_writes_to_the_installation(seen):
    assert seen["refused"] == []


def test_everything_plays(seen):
    names = changing(seen["figures"])
    for wanted in ("Player", "Cache", "Surface", "Traveling", "Blend Rough-Smooth", "fitted"):
        assert any(wanted in name for name in names), wanted
    assert {"Morph 0002", "Morph 0002.003"} <= names


def test_every_operator_can_be_polled_and_most_can_be_called(seen):
    """No poll may fail."""
    assert seen["polls"].keys() == seen["polls 2"].keys()
    assert len(seen["polls"]) >= 55
    never = {name for name, count in seen["polls 2"].items() if not count}
    # A map to the mirror image needs one object twice; the others need a live morph, or a mesh with shape keys.
    live = {"bake_live_morph", "end_live_morph", "keep_live_shape"}
    assert sorted(never - {"stop", "mirror_map", *live, "attach_parts", "bake_textures", "make_key_pad"}) == []


def test_every_panel_is_drawn(seen):
    assert len(seen["panels"]) >= 20
    # Progress is shown only during work, and the others for meshes with shape keys.
    idle = ["CONVWASS_PT_image_progress", "CONVWASS_PT_one_mesh", "CONVWASS_PT_progress", "CONVWASS_PT_textures"]
    assert sorted(name for name, count in seen["panels"].items() if not count) == idle


def test_presets_languages_and_manual_are_included(seen):
    assert seen["manual_page"] == "morphs.html"
    assert set(seen["presets"]) == {"Draft", "Standard", "Fine"}
    assert seen["languages"] == ["de", "fr"]


def test_disabling_and_removing_leave_only_the_work(seen, removed, profile):
    assert_same(seen["figures"], removed["figures"])
    assert removed["offered"] == seen["offered 2"]
    assert removed["offered 2"] == removed["offered 3"] == []
    assert_same(seen["figures"], removed["figures 2"])
    assert_same(seen["figures"], removed["figures 3"])
    assert not profile.extension.exists()


def test_the_work_plays_without_the_extension(seen, without):
    assert without["offered"] == []
    assert_same(seen["figures"], without["figures"])


def test_nothing_in_the_work_needs_the_extension(seen, without):
    for found in (seen["leftovers"], without["leftovers"]):
        assert {name: own for name, own in found.items() if own} == {}
