# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The manual in the zip files is complete, and Blender finds a page of it for every button and setting."""

from __future__ import annotations

import re
from pathlib import Path
from urllib.parse import unquote, urlparse

import bpy
import pytest

from convwass_addon import manual
from tests.fuzz.job_cases import kinds_of
from tools.manual import PAGES, write_manual


@pytest.fixture(scope="module")
def pages(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("manual") / "pages"
    write_manual(folder)
    return folder


def test_links_and_pictures_are_in_the_manual(pages):
    texts = {path.name: path.read_text(encoding="utf-8") for path in pages.glob("*.html")}
    assert texts.keys() == {f"{name}.html" for name in PAGES}
    for name, text in texts.items():
        for source in re.findall(r'src="([^"]*)"', text):
            assert (pages / source).stat().st_size > 1000, f"{name}: {source}"
        for link in re.findall(r'href="(?!https:)([^"]*)"', text):
            file, _, section = link.partition("#")
            assert not section or f'id="{section}"' in texts[file or name], f"{name}: {link}"
            assert not file or file in texts, f"{name}: {link}"
        assert ".md" not in re.sub(r"<code>.*?</code>", "", text, flags=re.DOTALL)


def page_of(identifier: str) -> Path:
    """Return the file that Blender's *Online Manual* opens for an identifier."""
    url = urlparse(bpy.types.WM_OT_doc_view_manual._lookup_rna_url(identifier, verbose=False))
    assert url.scheme == "file"
    return Path(unquote(url.path))


@pytest.mark.usefixtures("empty_scene")
def test_every_button_and_setting_has_a_page():
    operators = [kind.bl_idname for kind in kinds_of(bpy.types.Operator) if kind.__name__.startswith("CONVWASS_")]
    groups = [kind.__name__ for kind in kinds_of(bpy.types.PropertyGroup) if kind.__name__.startswith("CONVWASS_")]
    assert len(operators) > 60
    assert len(groups) > 10
    found = {page_of(f"bpy.ops.{name}") for name in operators} | {page_of(f"bpy.types.{name}.x") for name in groups}
    assert all(path.is_file() for path in found)
    assert {path.stem for path in found} == {page for kind in manual.PAGES.values() for _, page in kind}
    assert page_of("bpy.ops.convwass.live_morph").stem == "live"
    assert page_of("bpy.types.CONVWASS_PG_recolor.strength").stem == "palettes"
    assert page_of("bpy.types.CONVWASS_PG_morph.resolution").stem == "morphs"
