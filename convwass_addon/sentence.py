# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sentences for the user, which can be said in another language before they are filled in."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


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

    def __str__(self) -> str:
        return self.filled(self.template)

    def filled(self, template: str) -> str:
        """Return a translation of the template with the values in place; in English where it asks for others."""
        try:
            return template.format(**self.values) if self.values else template
        except (KeyError, IndexError, ValueError):
            return self.template.format(**self.values)
