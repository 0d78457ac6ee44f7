# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The texts of the user interface in other languages than English: a table per language."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ..sentence import Sentence
from . import (
    french,
    french_armatures,
    french_densities,
    french_flat,
    french_light,
    french_messages,
    french_recolor,
    french_reflectance,
    french_soft_maps,
    german,
    german_armatures,
    german_densities,
    german_flat,
    german_light,
    german_messages,
    german_recolor,
    german_reflectance,
    german_soft_maps,
)


def _joined(*tables: dict[str, str]) -> dict[str, str]:
    """Join the tables of a language; raises ValueError where a text stands in two of them."""
    joined = {}
    for table in tables:
        double = joined.keys() & table.keys()
        if double:
            raise ValueError(f"translated twice: {sorted(double)}")
        joined |= table
    return joined


TABLES: dict[str, dict[str, str]] = {
    "de_DE": _joined(
        german.TEXTS,
        german_messages.TEXTS,
        german_densities.TEXTS,
        german_flat.TEXTS,
        german_soft_maps.TEXTS,
        german_armatures.TEXTS,
        german_light.TEXTS,
        german_reflectance.TEXTS,
        german_recolor.TEXTS,
    ),
    "fr_FR": _joined(
        french.TEXTS,
        french_messages.TEXTS,
        french_densities.TEXTS,
        french_flat.TEXTS,
        french_soft_maps.TEXTS,
        french_armatures.TEXTS,
        french_light.TEXTS,
        french_reflectance.TEXTS,
        french_recolor.TEXTS,
    ),
}
"""For every language, the translation of every English text."""

# Blender looks for the labels of operators in the second context, and for everything else in the first.
_CONTEXTS = ("*", "Operator")


def translated(sentence: Sentence) -> str:
    """Return a sentence in the language of the user interface; in English where it has no translation."""
    values = {name: translated(own) if isinstance(own, Sentence) else own for name, own in sentence.values.items()}
    return Sentence(sentence.template, values).filled(rpt_(sentence.template))


def register() -> None:
    """Hand the tables to Blender."""
    texts = {
        language: {(context, english): own for english, own in table.items() for context in _CONTEXTS}
        for language, table in TABLES.items()
    }
    bpy.app.translations.register(__package__, texts)


def unregister() -> None:
    """Take them back."""
    bpy.app.translations.unregister(__package__)
