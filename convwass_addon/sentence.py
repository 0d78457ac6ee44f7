# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sentences for the user that can be translated before their values are filled in."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from string import Formatter

# The format specifications used by the project's messages: alignment, sign, width, precision, type.
_SPECIFICATION = re.compile(r"[<>^]?[+,]?\d{0,2}(\.\d)?[a-z%]?")


@dataclass(frozen=True)
class Sentence:
    """A template and its values.

    Attributes
    ----------
    template : str
        English, with placeholders as for :meth:`str.format`; plain text if there are no values.
    values : mapping
        Values of the placeholders.
    """

    template: str
    values: Mapping[str, object] = field(default_factory=dict)

    @property
    def is_plain(self) -> bool:
        """Whether the template uses only plain placeholders with simple format specifications.

        Checked for templates read from files before they are filled in.
        """
        fields = [(name, form) for _, name, form, _ in Formatter().parse(self.template) if name is not None]
        return all(name.isidentifier() and _SPECIFICATION.fullmatch(form or "") for name, form in fields)

    def __str__(self) -> str:
        return self.filled(self.template)

    def filled(self, template: str) -> str:
        """Fill in a translation of the template, or the English template if the translation has other placeholders."""
        try:
            return template.format(**self.values) if self.values else template
        except (KeyError, IndexError, ValueError):
            return self.template.format(**self.values)


def first_names(names: Sequence[str], most: int = 5) -> str:
    """Join the first names of a list with commas; dots stand for the others."""
    return ", ".join(names[:most]) + (", ..." if len(names) > most else "")


def as_sentence(text: str) -> Sentence:
    """Return a text that Blender already translates, such as the label of a property, as a part of another sentence."""
    return Sentence(text)
