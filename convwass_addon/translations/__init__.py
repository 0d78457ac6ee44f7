# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Translations of the user interface, one ``.po`` file per language."""

from __future__ import annotations

from pathlib import Path

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ..sentence import Sentence
from .po_file import DEFAULT_CONTEXT, read_po

FOLDER = Path(__file__).parent

# Context in which Blender looks up labels of operators; everything else uses the default context.
_OPERATOR_CONTEXT = "Operator"


def languages() -> list[str]:
    """Return the available languages by Blender's names, which are the file names."""
    return sorted(path.stem for path in FOLDER.glob("*.po"))


def catalog(language: str) -> dict[tuple[str, str], str]:
    """Return the translations of a language, by context and English text.

    A text without a context is also used for labels of operators. Blender shows the English text if there is no
    translation.
    """
    found = read_po(FOLDER / f"{language}.po")
    everywhere = {text: own for (context, text), own in found.items() if context == DEFAULT_CONTEXT}
    return {(_OPERATOR_CONTEXT, text): own for text, own in everywhere.items()} | found


def translated(sentence: Sentence) -> str:
    """Return a sentence, including nested sentences, in the language of Blender's interface."""
    values = {name: translated(own) if isinstance(own, Sentence) else own for name, own in sentence.values.items()}
    return Sentence(sentence.template, values).filled(rpt_(sentence.template))


def register() -> None:
    """Register the translations with Blender."""
    bpy.app.translations.register(__package__, {language: catalog(language) for language in languages()})


def unregister() -> None:
    """Unregister the translations."""
    bpy.app.translations.unregister(__package__)
