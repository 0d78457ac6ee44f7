# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Translations use the values of their English texts, and all user-visible texts are found in the source."""

from __future__ import annotations

import ast
from string import Formatter
from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from convwass_addon import translations
from convwass_addon.applications.morphs.part_labels import FaceLabels, matched
from convwass_addon.errors import InputError
from convwass_addon.sentence import Sentence
from convwass_addon.translations import catalog, languages, translated
from tools.ui_texts import Message, all_texts, messages, messages_of, texts_of_call

pytestmark = pytest.mark.usefixtures("empty_scene")

LANGUAGES = languages()


@pytest.fixture
def in_german(monkeypatch):
    """Blender in German, simulated because the bpy module is built without languages."""
    german = catalog("de")
    monkeypatch.setattr(translations, "rpt_", lambda text: german.get(("*", text), text))


def fields(text: str) -> list[tuple[str, str, str]]:
    """Return the names in braces with their format specifications."""
    found = Formatter().parse(text)
    return sorted((name, conversion or "", spec or "") for _, name, spec, conversion in found if name is not None)


def complaint(message: Message) -> str | None:
    """Explain why a sentence cannot be translated before it is filled in; None if it can."""
    if not message.is_literal:
        return "its template is not written out"
    given = given_values(message.call)
    wrong = [text for text in message.templates if {name for name, _, _ in fields(text)} != given]
    return f"{wrong[0]!r} is given {sorted(given)}" if given is not None and wrong else None


def given_values(call: ast.Call) -> set[str] | None:
    """Return the names of the values passed to a template; None if they are not literal."""
    names = {keyword.arg for keyword in call.keywords}
    for table in call.args[1:]:
        names |= {getattr(key, "value", None) for key in table.keys} if isinstance(table, ast.Dict) else {None}
    return None if None in names else names


def test_languages_exist():
    assert LANGUAGES == ["de", "fr"]
    assert all(len(catalog(language)) > 2000 for language in LANGUAGES)


@pytest.mark.parametrize("language", LANGUAGES)
def test_translations_use_the_same_values_in_the_same_format(language):
    for (_, english), own in catalog(language).items():
        assert own.strip() == own, english
        assert fields(own) == fields(english), english
        assert own.endswith(".") == english.endswith("."), english


@pytest.mark.parametrize("language", LANGUAGES)
def test_unnamed_values_have_the_same_order(language):
    for (_, english), own in catalog(language).items():
        kinds = [[spec for _, name, spec, _ in Formatter().parse(text) if name == ""] for text in (english, own)]
        assert kinds[0] == kinds[1], english


def test_texts_in_the_source_are_found():
    """One text of each kind is found, so that `run.py translations` lists it if it is missing."""
    source = (
        "rpt_('a'); cls.poll_message_set('b'); layout.label(text='c'); layout.operator(name, text='d');"
        "self.report({'INFO'}, 'e'); layout.row(heading='f');"
        "layout.label(text='no', translate=False); iface_(variable)"
    )
    calls = [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Call)]
    assert {text for call in calls for text in texts_of_call(call)} == set("abcdef")
    texts = all_texts()
    for known in ("Bake Morph", "Resolution", "As Placed", "Go to Object Mode first", "Make a List", "Cache Folder"):
        assert known in texts


def test_translations_are_registered_also_for_operator_labels_and_unregistered(monkeypatch):
    """The bpy module is built without languages, so the registered translations are intercepted."""
    given = {}
    fake = SimpleNamespace(register=given.__setitem__, unregister=given.__delitem__)
    monkeypatch.setattr(translations, "bpy", SimpleNamespace(app=SimpleNamespace(translations=fake)))
    translations.register()
    (texts,) = given.values()
    assert texts["de"]["Operator", "Bake Morph"] == texts["de"]["*", "Bake Morph"] == "Morph backen"
    assert sorted(texts) == LANGUAGES
    translations.unregister()
    assert given == {}


def test_sentences_can_be_translated_before_they_are_filled_in():
    found = messages()
    assert len(found) > 100
    assert [f"{place}: {wrong}" for place, message in found if (wrong := complaint(message))] == []


@pytest.mark.parametrize(
    ("source", "templates"),
    [
        ("InputError('No.')", ["No."]),
        ("InputError('{a} is no {b:g}.', a=1, b=2.0)", ["{a} is no {b:g}."]),
        ("InputError('{a}', **values)", ["{a}"]),
        ("Sentence('{a} of {b}', {'a': 1, 'b': 2})", ["{a} of {b}"]),
        ("Sentence('{a} of {b}', values)", ["{a} of {b}"]),
        ("InputError('{a} one' if a == 1 else '{a} ones', a=a)", ["{a} one", "{a} ones"]),
        ("TEXT = 'No.'\nInputError(TEXT)", ["No."]),
        ("TEXTS: dict = {'A': 'No.', **OTHERS, 'B': '{b}'}\nSentence(TEXTS[kind], values)", ["No.", "{b}"]),
    ],
)
def test_templates_are_found(source, templates):
    ((_, message),) = messages_of(source)
    assert message.templates == templates
    assert complaint(message) is None


@pytest.mark.parametrize(
    ("source", "wrong"),
    [
        ("InputError(f'No {a}.')", "not written out"),
        ("InputError('No ' + a)", "not written out"),
        ("InputError('No {}.'.format(a))", "not written out"),
        ("InputError('No %s.' % a)", "not written out"),
        ("InputError(rpt_('No.'))", "not written out"),
        ("InputError(message)", "not written out"),
        ("InputError('one' if one else message)", "not written out"),
        ("TEXT = f'No {a}.'\nInputError(TEXT)", "not written out"),
        ("TEXTS = {'A': 'No.', 'B': f'No {b}.'}\nSentence(TEXTS[kind], values)", "not written out"),
        ("InputError()", "not written out"),
        ("InputError('{a} is no number.', b=1)", "is given ['b']"),
        ("InputError('{a} is no number.')", "is given []"),
        ("Sentence('{a}', {'b': 1})", "is given ['b']"),
        ("InputError('one' if one else '{n} ones', n=n)", "'one' is given"),
    ],
)
def test_untranslatable_sentences_are_found(source, wrong):
    ((_, message),) = messages_of(source)
    assert wrong in complaint(message)


@pytest.mark.usefixtures("in_german")
def test_nested_sentences_are_translated():
    inner = Sentence("{names} and {more} more", {"names": "A, B", "more": 3})
    sentence = Sentence(
        "{file} has no object {name!r}; it contains {listed}.", {"file": "a", "name": "b", "listed": inner}
    )
    assert translated(sentence) == "a hat kein Objekt 'b'; die Datei enthält A, B und 3 weitere."
    assert str(sentence) == "a has no object 'b'; it contains A, B and 3 more."
    assert translated(Sentence("Blend {done} of {total}", {"done": 1, "total": 9})) == "Mischung 1 von 9"
    assert translated(Sentence("Unheard of {so}", {"so": "{far}"})) == "Unheard of {far}"


def test_an_invalid_translation_falls_back_to_english(monkeypatch):
    monkeypatch.setattr(translations, "rpt_", lambda text: "{nonsense}")
    assert translated(Sentence("Preview {done} of {total}", {"done": 1, "total": 2})) == "Preview 1 of 2"


@pytest.fixture
def two_shapes(empty_scene):
    for name in "AB":
        bpy.ops.mesh.primitive_cube_add()
        bpy.context.object.name = name


@pytest.mark.usefixtures("in_german", "two_shapes")
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"inputs": "A, nobody"}, "Es gibt kein Objekt namens nobody; die Namen der Eingaben prüfen."),
        ({"inputs": "A, B", "weights": "1, x"}, "Gewichte sind Zahlen mit Kommas dazwischen, nicht '1, x'."),
        ({"inputs": "A, B", "layout": "GRID"}, "genau vier Formen"),
    ],
)
def test_operators_refuse_in_the_language_of_the_user(arguments, message):
    with pytest.raises(RuntimeError, match=message):
        bpy.ops.convwass.bake_morph(motion="TRANSPORT", **arguments)


@pytest.mark.usefixtures("in_german", "two_shapes")
def test_findings_of_a_check_are_in_the_language_of_the_user():
    """Nested errors: the mesh describes the defect, and the object names the mesh."""
    bpy.data.objects["A"].data.vertices[0].co = (np.nan, 0.0, 0.0)
    bpy.data.objects["A"].select_set(True)
    bpy.ops.convwass.add_morph_inputs()
    findings = {item.object.name: item.finding for item in bpy.context.scene.convwass_morph.inputs}
    assert findings["A"].startswith(
        "A: 1 von 8 Vertices haben Koordinaten, die keine Zahlen sind (NaN oder unendlich). "
    )
    assert findings["A"].endswith("Diese Vertices löschen, oder den Modifikator, der sie erzeugt")


@pytest.mark.usefixtures("in_german")
def test_unmatched_parts_are_named_in_the_language_of_the_user():
    with pytest.raises(InputError) as caught:
        matched([FaceLabels(("a",), np.zeros(2, np.int64)), FaceLabels((), np.full(2, -1))], ["A", "B"])
    assert "(A hat a; B hat keine)" in translated(caught.value.sentence)
