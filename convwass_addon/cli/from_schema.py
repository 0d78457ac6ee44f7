# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Command-line options generated from the settings of the applications."""

from __future__ import annotations

from argparse import SUPPRESS, ArgumentParser, ArgumentTypeError, BooleanOptionalAction, Namespace
from collections.abc import Callable, Container, Sequence

from ..schema import Setting, Settings, settings_of


def add_setting_options(
    parser: ArgumentParser,
    *kinds: type[Settings],
    only: Container[str] | None = None,
    without: Container[str] = (),
) -> None:
    """Add an option for every setting that has one.

    Parameters
    ----------
    parser : ArgumentParser
        The parser of the command, or one of its option groups.
    *kinds : type
        Settings classes. If several classes share an option, and the shapes decide which one applies, the help shows
        both texts.
    only, without : container of str
        Names of fields; see :func:`.schema.settings_of`.
    """
    by_option: dict[str, list[Setting]] = {}
    for kind in kinds:
        for one in settings_of(kind, only, without):
            alike = by_option.setdefault(one.option, []) if one.option is not None else [one]
            if one not in alike:
                alike.append(one)
    for option, alike in by_option.items():
        text = "; ".join(map(_help, alike)).replace("%", "%%")
        # Options that are not given stay out of the namespace, so that the defaults of the settings apply.
        parser.add_argument(option, dest=alike[0].name, default=SUPPRESS, help=text, **_form(alike[0]))


def given_settings(options: Namespace, kind: type[Settings], only: Container[str] | None = None) -> dict[str, object]:
    """Return the settings given on the command line, by field name."""
    return {one.name: _value(one, getattr(options, one.name)) for one in _given(options, kind, only)}


def given_options(options: Namespace, kind: type[Settings], only: Container[str] | None = None) -> list[str]:
    """Return the names of the settings' options that were given on the command line, such as --resolution."""
    return [one.option for one in _given(options, kind, only)]


def _given(options: Namespace, kind: type[Settings], only: Container[str] | None) -> list[Setting]:
    return [one for one in settings_of(kind, only) if one.option is not None and hasattr(options, one.name)]


def _value(one: Setting, given: object) -> object:
    by_word = {choice.word: choice.value for choice in one.choices if choice.value is not float}
    return by_word.get(given, given)


def _form(one: Setting) -> dict[str, object]:
    """Return the arguments of ``add_argument`` for a setting."""
    if one.flag is not None:
        return {"action": "store_const", "const": one.choice(one.flag).word}
    words = [choice.word for choice in one.choices]
    if one.number is not None:
        return {"type": _word_or_number(words), "metavar": "|".join(words)}
    if one.choices:
        return {"choices": words}
    if one.kind is bool:
        return {"action": BooleanOptionalAction} if one.default else {"action": "store_true"}
    return {"type": one.kind, "metavar": _metavar(one)}


def _metavar(one: Setting) -> str:
    return "N" if one.kind is int else "X" if one.kind is float else "TEXT"


def _word_or_number(words: Sequence[str]) -> Callable[[str], str | float]:
    """Return a converter that accepts some words, or a number if NUMBER is among them."""

    def read(text: str) -> str | float:
        if text in words and text != "NUMBER":
            return text
        try:
            return float(text)
        except ValueError:
            known = ", ".join(word for word in words if word != "NUMBER")
            raise ArgumentTypeError(f"{text!r} is not {known} or a number") from None

    return read


def _help(one: Setting) -> str:
    """Return the help text of an option: its meaning, its choices or range, and the default in brackets."""
    if one.flag is not None:
        return _small(one.help or one.choice(one.flag).description)
    text = _small(one.help or one.description)
    if one.choices and not one.help:
        text += "; " + "; ".join(f"{choice.word}: {_small(choice.description)}" for choice in one.choices)
    if one.range_text and not one.choices:
        text += f"; {one.range_text}"
    usual = _usual(one)
    return f"{text} ({usual})" if usual else text


def _usual(one: Setting) -> str:
    if one.kind is bool:
        return "on" if one.default else ""
    if one.choices:
        return one.choice(one.default).word
    return one.automatic if one.default is None else f"{one.default:g}" if one.kind is float else str(one.default)


def _small(text: str) -> str:
    """Return a text with a lower-case initial, for use within a sentence."""
    return text if text[1:2].isupper() else text[:1].lower() + text[1:]
