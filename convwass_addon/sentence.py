# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sentences for the user, which can be said in another language before they are filled in."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from string import Formatter

# Alignment, sign, width, places and type, as the project's own messages have them.
_SPECIFICATION = re.compile(r"[<>^]?[+,]?\d{0,2}(\.\d)?[a-z%]?")


@dataclass(frozen=True)
class Sentence:
    """A template and what it is filled with.

    Attributes
    ----------
    template : str
        English, with names in braces as for :meth:`str.format`; text as it is where there are no values.
    values : mapping
        What the names stand for.
    """

    template: str
    values: Mapping[str, object] = field(default_factory=dict)

    @property
    def is_plain(self) -> bool:
        """Whether the template takes values as they are: no parts of them, and no more room than a message has.

        What comes from a file is asked this before it is filled in.
        """
        fields = [(name, form) for _, name, form, _ in Formatter().parse(self.template) if name is not None]
        return all(name.isidentifier() and _SPECIFICATION.fullmatch(form or "") for name, form in fields)

    def __str__(self) -> str:
        return self.filled(self.template)

    def filled(self, template: str) -> str:
        """Return a translation of the template with the values in place; in English where it asks for others."""
        try:
            return template.format(**self.values) if self.values else template
        except (KeyError, IndexError, ValueError):
            return self.template.format(**self.values)


def as_sentence(text: str) -> Sentence:
    """Return a text that Blender knows already, such as the label of a property, as a part of another sentence."""
    return Sentence(text)
