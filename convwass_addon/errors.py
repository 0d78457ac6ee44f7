# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The errors whose message is meant for the person at the keyboard."""

from __future__ import annotations

from .sentence import Sentence


class ConvwassError(Exception):
    """Something the user can act on; the message says what to do.

    Parameters
    ----------
    template : str
        The message in English, with names in braces for what only the moment knows.
    values
        What these names stand for.
    """

    def __init__(self, template: str, /, **values: object) -> None:
        self.sentence = Sentence(template, values)
        super().__init__(str(self.sentence))

    def __reduce__(self) -> tuple[object, ...]:
        # Errors come back from other processes.
        return _rebuilt, (type(self), self.sentence)


def _rebuilt(kind: type[ConvwassError], sentence: Sentence) -> ConvwassError:
    return kind(sentence.template, **sentence.values)


class InputError(ConvwassError, ValueError):
    """The input cannot be used as it is; also a ValueError, as of other libraries."""


class ResourceError(ConvwassError):
    """The job asks for more than this machine has."""


class Cancelled(ConvwassError):
    """The user stopped the job; what was finished is kept."""
