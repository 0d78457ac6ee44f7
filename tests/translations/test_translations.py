# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every text of the user interface is there in every language, and can be filled with the same values."""

from __future__ import annotations

import ast
from string import Formatter
from types import SimpleNamespace

import pytest

from convwass_addon import translations
from convwass_addon.translations import TABLES

from .texts import _texts_of_call, all_texts

pytestmark = pytest.mark.usefixtures("empty_scene")

LANGUAGES = sorted(TABLES)


def fields(text: str) -> list[tuple[str | None, str | None]]:
    return sorted((name or "", spec or "") for _, name, spec, _ in Formatter().parse(text) if name is not None)


def test_there_are_languages():
    assert LANGUAGES == ["de_DE", "fr_FR"]


@pytest.mark.parametrize("language", LANGUAGES)
def test_nothing_is_missing(language):
    assert sorted(all_texts() - TABLES[language].keys()) == []


@pytest.mark.parametrize("language", LANGUAGES)
def test_nothing_is_left_over(language):
    assert sorted(TABLES[language].keys() - all_texts()) == []


@pytest.mark.parametrize("language", LANGUAGES)
def test_translations_take_the_same_values_in_the_same_form(language):
    for english, own in TABLES[language].items():
        assert own.strip() == own != "", english
        assert fields(own) == fields(english), english
        assert own.endswith(".") == english.endswith("."), english


@pytest.mark.parametrize("language", LANGUAGES)
def test_unnamed_values_stand_in_the_same_order(language):
    for english, own in TABLES[language].items():
        kinds = [[spec for _, name, spec, _ in Formatter().parse(text) if name == ""] for text in (english, own)]
        assert kinds[0] == kinds[1], english


def test_the_source_is_read_for_texts():
    """One of each kind is found, so that a text that is missing from a table is noticed."""
    source = (
        "rpt_('a'); cls.poll_message_set('b'); layout.label(text='c'); layout.operator(name, text='d');"
        "self.report({'INFO'}, 'e'); layout.row(heading='f');"
        "layout.label(text='no', translate=False); iface_(variable)"
    )
    calls = [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Call)]
    assert {text for call in calls for text in _texts_of_call(call)} == set("abcdef")
    texts = all_texts()
    for known in ("Bake Morph", "Resolution", "As Placed", "Go to Object Mode first", "Make a List", "Cache Folder"):
        assert known in texts


def test_blender_gets_them_for_labels_of_operators_too_and_takes_them_back(monkeypatch):
    """The bpy module is built without languages, so what it is given is caught on the way."""
    given = {}
    fake = SimpleNamespace(register=given.__setitem__, unregister=given.__delitem__)
    monkeypatch.setattr(translations, "bpy", SimpleNamespace(app=SimpleNamespace(translations=fake)))
    translations.register()
    (texts,) = given.values()
    assert texts["de_DE"]["Operator", "Bake Morph"] == texts["de_DE"]["*", "Bake Morph"] == "Morph backen"
    assert texts.keys() == TABLES.keys()
    translations.unregister()
    assert given == {}
