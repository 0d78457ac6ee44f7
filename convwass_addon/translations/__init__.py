# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The texts of the user interface in other languages than English, one ``.po`` file for each."""

from __future__ import annotations

from pathlib import Path

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ..sentence import Sentence
from .po_file import DEFAULT_CONTEXT, read_po

FOLDER = Path(__file__).parent

# Blender looks for the labels of operators in this context, and for everything else in the default one.
_OPERATOR_CONTEXT = "Operator"


def languages() -> list[str]:
    """Return the languages that there are translations for, as Blender names them: the names of the files."""
    return sorted(path.stem for path in FOLDER.glob("*.po"))


def catalog(language: str) -> dict[tuple[str, str], str]:
    """Return the translations into a language by context and English text.

    A text without a context of its own is translated in the same way everywhere, so it is there for labels of operators
    as well. Blender shows the English text where there is none.
    """
    found = read_po(FOLDER / f"{language}.po")
    everywhere = {text: own for (context, text), own in found.items() if context == DEFAULT_CONTEXT}
    return {(_OPERATOR_CONTEXT, text): own for text, own in everywhere.items()} | found


def translated(sentence: Sentence) -> str:
    """Return a sentence in the language of Blender's interface; so are the sentences that it holds."""
    values = {name: translated(own) if isinstance(own, Sentence) else own for name, own in sentence.values.items()}
    return Sentence(sentence.template, values).filled(rpt_(sentence.template))


def register() -> None:
    """Give Blender the translations into all languages."""
    bpy.app.translations.register(__package__, {language: catalog(language) for language in languages()})


def unregister() -> None:
    """Take them back."""
    bpy.app.translations.unregister(__package__)
