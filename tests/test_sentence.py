# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sentences are filled in late, and errors keep their sentence across processes."""

from __future__ import annotations

import pickle

import pytest
from hypothesis import given, strategies as st

from convwass_addon.errors import Cancelled, ConvwassError, InputError, ResourceError
from convwass_addon.progress import Progress
from convwass_addon.sentence import Sentence

VALUES = st.one_of(st.text(), st.integers(), st.floats(allow_nan=False))


def test_a_sentence_without_values_is_its_template():
    assert str(Sentence("Curly {braces} and {} stay")) == "Curly {braces} and {} stay"


@given(VALUES)
def test_values_are_never_interpreted_as_templates(value):
    assert str(Sentence("{a}: {b}", {"a": value, "b": "{a}"})) == f"{value}: {{a}}"


@pytest.mark.parametrize("template", ["{b}", "{}", "{a:d}", "{a", "{a!x}"])
def test_a_mismatched_translation_falls_back_to_english(template):
    assert Sentence("{a} left", {"a": "nothing"}).filled(template) == "nothing left"


def test_sentences_can_be_nested():
    assert str(Sentence("{a}!", {"a": Sentence("{b} and {c}", {"b": 1, "c": 2})})) == "1 and 2!"


@pytest.mark.parametrize("kind", [ConvwassError, InputError, ResourceError, Cancelled])
@given(values=st.dictionaries(st.sampled_from(["name", "count", "kind", "template", "self"]), VALUES))
def test_errors_survive_pickling(kind, values):
    template = " ".join(f"{{{name}}}" for name in values) + " or so."
    error = kind(template, **values)
    back = pickle.loads(pickle.dumps(error))
    assert type(back) is kind
    assert str(back) == str(error) == template.format_map(values)
    assert back.sentence == error.sentence == Sentence(template, values)


def test_nested_errors_survive_pickling():
    inner = InputError("{count} vertices are nowhere.", count=3)
    error = InputError("{name}: {reason}", name="A", reason=inner.sentence)
    back = pickle.loads(pickle.dumps(error))
    assert str(back) == "A: 3 vertices are nowhere."
    assert back.sentence.values["reason"] == inner.sentence


def test_progress_survives_pickling():
    step = Progress(0.5, Sentence("Blend {done} of {total}", {"done": 1, "total": 2}))
    assert pickle.loads(pickle.dumps(step)) == step
    assert str(step.message) == "Blend 1 of 2"
