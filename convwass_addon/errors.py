# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors with messages for the user."""

from __future__ import annotations

from .sentence import Sentence


class ConvwassError(Exception):
    """An error that the user can act on; the message says how.

    Parameters
    ----------
    template : str
        The message in English, with named placeholders in braces.
    values
        Values of the placeholders.
    """

    def __init__(self, template: str, /, **values: object) -> None:
        self.sentence = Sentence(template, values)
        super().__init__(str(self.sentence))

    def __reduce__(self) -> tuple[object, ...]:
        # Errors may be pickled by other processes.
        return _rebuilt, (type(self), self.sentence)


def _rebuilt(kind: type[ConvwassError], sentence: Sentence) -> ConvwassError:
    return kind(sentence.template, **sentence.values)


class InputError(ConvwassError, ValueError):
    """The input cannot be used as it is. Also a ValueError, for callers from other libraries."""


class ResourceError(ConvwassError):
    """The job needs more resources than this machine has."""


class Cancelled(ConvwassError):
    """The user stopped the job; finished results are kept."""
