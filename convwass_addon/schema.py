# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings that are declared once, on the fields of a dataclass, and used by every layer.

A setting is one line::

    @dataclass(frozen=True)
    class BrushSettings(Settings):
        \"\"\"How a brush paints.\"\"\"

        radius: float = setting(0.1, "Radius", "How far the brush reaches", least=0.0, most=10.0)

From it are made the check of the value, the property in Blender (:mod:`.properties.from_schema`), the option of the
command line (:mod:`.cli.from_schema`), the row in a panel (:mod:`.panels.from_schema`), the entry that is stored
(:meth:`Settings.as_dict`) and the line in the docstring, which the pages about the API show.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Container, Iterator
from dataclasses import Field, asdict, dataclass, field, fields, replace
from functools import cache
from numbers import Integral, Real
from typing import Any

from .errors import InputError
from .sentence import Sentence, as_sentence

_KEY = "convwass"


@dataclass(frozen=True)
class Choice:
    """One of the values that a setting can have.

    Attributes
    ----------
    value : str, None or the type float
        In the dataclass; `float` stands for any number.
    label, description : str
        What users read.
    identifier : str
        In Blender: the value in capitals by default; "OFF" for None, "NUMBER" for any number.
    word : str
        On the command line: the value in small letters by default; "off" for None, "NUMBER" for any number.
    """

    value: str | type[float] | None
    label: str
    description: str
    identifier: str = ""
    word: str = ""

    def __post_init__(self) -> None:
        """Derive the two spellings that are left out."""
        name = "off" if self.value is None else "number" if self.value is float else str(self.value)
        word = "NUMBER" if self.value is float else name.lower().replace("_", "-")
        object.__setattr__(self, "identifier", self.identifier or name.upper().replace("-", "_"))
        object.__setattr__(self, "word", self.word or word)


@dataclass(frozen=True)
class Companion:
    """A second property in Blender, which has one type for a property and no word for None.

    Attributes
    ----------
    name, label, description : str
        Of the property.
    start : float
        The number that Blender shows first.
    """

    name: str
    label: str
    description: str
    start: float


@dataclass(frozen=True)
class Setting:
    """What is known about a setting.

    Attributes
    ----------
    default : object
        None where the value is chosen automatically; see `automatic`.
    label : str
        Its name for users, in title case.
    description : str
        What it means, in the words of Blender's tips: no article at the start, no full stop at the end. The help of the
        command line and the pages about the API say the same.
    name : str
        Of the field; filled in by :func:`settings_of`.
    least, most : float or None
        Range of a number.
    open_ends : bool
        Whether the ends of the range are excluded.
    soft_least, soft_most : float or None
        Range of the slider in Blender; with `open_ends` also the range of the property.
    unit : str
        Of a number, such as "cells"; for the pages about the API.
    subtype : str
        Of Blender: "FACTOR", "DISTANCE", "PIXEL", "DIR_PATH" and so on. "ANGLE" is in degrees here.
    precision, step : float or None
        Of Blender: decimal places, and what an arrow changes.
    choices : tuple of Choice
        The values that there are; one of them may be any number.
    automatic : str
        What None stands for.
    switch : Companion or None
        Of a number that may be None: the property that says whether it is set by hand.
    number : Companion or None
        Of a setting one of whose choices is any number: the property of the number.
    zero_is_automatic : bool
        Whether 0 in Blender stands for None.
    prop : str or None
        Name in Blender, the field's by default; None where Blender has no such property.
    option : str or None
        Name on the command line, by default the field's with hyphens; None where there is no such option.
    flag : str or None
        Of a setting with choices: the option is a flag that chooses this value.
    help : str
        What it means, for the command line and for scripts, where the description speaks of Blender.
    note : str
        What only those who write scripts need to know; for the pages about the API.
    panel : str
        Which panel shows it, where the panel is made from the schema.
    applies_when : tuple of str
        Name of another setting and the value that it must have for this one to have an effect; () for none.
    preset : bool
        Whether presets of the solver set it.
    """

    default: Any
    label: str
    description: str
    name: str = ""
    least: float | None = None
    most: float | None = None
    open_ends: bool = False
    soft_least: float | None = None
    soft_most: float | None = None
    unit: str = ""
    subtype: str = "NONE"
    precision: int | None = None
    step: float | None = None
    choices: tuple[Choice, ...] = ()
    automatic: str = ""
    switch: Companion | None = None
    number: Companion | None = None
    zero_is_automatic: bool = False
    prop: str | None = ""
    option: str | None = ""
    flag: str | None = None
    help: str = ""
    note: str = ""
    panel: str = ""
    applies_when: tuple[str, ...] = ()
    preset: bool = True

    def named(self, name: str) -> Setting:
        """Return the setting with the name of its field, and the names that follow from it."""
        option = "--" + name.replace("_", "-") if self.option == "" else self.option
        return replace(self, name=name, prop=name if self.prop == "" else self.prop, option=option)

    @property
    def kind(self) -> type:
        """The type of its values: bool, int, float or str; numbers that may be None are float."""
        if self.choices:
            return str
        return float if self.default is None else type(self.default)

    @property
    def properties(self) -> tuple[str, ...]:
        """The names of its properties in Blender."""
        if self.prop is None:
            return ()
        return (*(one.name for one in (self.switch, self.number) if one), self.prop)

    def choice(self, value: object) -> Choice:
        """Return the choice that has a value, or its spelling in Blender; ValueError where there is none."""
        for choice in self.choices:
            if choice.value is not float and value in (choice.value, choice.identifier):
                return choice
        if _is_number(value):
            for choice in self.choices:
                if choice.value is float:
                    return choice
        raise ValueError(f"{self.name} is {value!r}")

    def check(self, value: object) -> None:
        """Refuse a value that the setting cannot have.

        Raises
        ------
        InputError
            With the label and what the value must be.
        """
        if self.choices:
            self._check_choice(value)
        elif self.kind is bool:
            if value not in (True, False):
                raise InputError("{name} must be on or off, not {value!r}.", name=self._said(), value=value)
        elif self.kind in (int, float) and not (value is None and self.default is None):
            self._check_number(value)

    def _said(self) -> Sentence:
        """Return the label, and the name of the field where that is another word, for those who write scripts."""
        label = as_sentence(self.label)
        if self.label.lower().replace(" ", "_") == self.name:
            return label
        return Sentence("{label} ({field})", {"label": label, "field": self.name})

    def _check_choice(self, value: object) -> None:
        if value in [choice.value for choice in self.choices if choice.value is not float]:
            return
        if _is_number(value) and any(choice.value is float for choice in self.choices):
            return
        known = ", ".join(_shown(choice.value) for choice in self.choices)
        raise InputError(
            "{name} must be one of {choices}, not {value!r}.", name=self._said(), choices=known, value=value
        )

    def _check_number(self, value: object) -> None:
        name = self._said()
        if not _is_number(value):
            raise InputError("{name} must be a number, not {value!r}.", name=name, value=value)
        if self.kind is int and not isinstance(value, Integral):
            raise InputError("{name} must be a whole number, not {value!r}.", name=name, value=value)
        least = -math.inf if self.least is None else self.least
        most = math.inf if self.most is None else self.most
        if least < value < most or (not self.open_ends and value in (least, most)):
            return
        given = {"name": name, "least": least, "most": most, "value": value}
        if self.open_ends and self.most is None:
            raise InputError("{name} must be more than {least:g}, not {value:g}.", name=name, least=least, value=value)
        if self.open_ends:
            raise InputError("{name} must be more than {least:g} and less than {most:g}, not {value:g}.", **given)
        if self.most is None:
            raise InputError("{name} must be {least:g} or more, not {value:g}.", name=name, least=least, value=value)
        raise InputError("{name} must lie between {least:g} and {most:g}, not {value:g}.", **given)

    @property
    def range_text(self) -> str:
        """The range of a number in words; empty where there is none."""
        if self.least is None and self.most is None:
            return ""
        if self.open_ends and self.most is None:
            text = f"more than {self.least:g}"
        elif self.open_ends:
            text = f"more than {self.least:g}, less than {self.most:g}"
        elif self.most is None:
            text = f"{self.least:g} or more"
        else:
            text = f"{self.least:g} to {self.most:g}"
        return f"{text} {self.unit}".rstrip()

    @property
    def type_text(self) -> str:
        """The type in the words of a docstring, with its range."""
        if self.choices:
            *most, last = (_shown(choice.value) for choice in self.choices)
            return f"{', '.join(most)} or {last}" if most else last
        parts = [self.kind.__name__ + (" or None" if self.default is None else ""), self.range_text]
        return ", ".join(filter(None, parts))


class Settings:
    """A record of settings: its values are checked when it is made, and its docstring lists its fields."""

    def __init_subclass__(cls, **options: object) -> None:
        """Add the class's own settings to its docstring, whose last section may be its other attributes."""
        super().__init_subclass__(**options)
        if cls.__doc__:
            own = [
                value.metadata[_KEY].named(name)
                for name, value in vars(cls).items()
                if isinstance(value, Field) and _KEY in value.metadata
            ]
            text = inspect.cleandoc(cls.__doc__)
            title = [] if "\nAttributes\n---" in text else ["", "Attributes", "----------"]
            cls.__doc__ = "\n".join([text, *title, *(line for one in own for line in _documented(one))]) + "\n"

    def __post_init__(self) -> None:
        """Refuse values that make no sense.

        Raises
        ------
        InputError
            With the label of the setting and what it must be.
        """
        for one in settings_of(type(self)):
            one.check(getattr(self, one.name))

    def as_dict(self) -> dict[str, object]:
        """Return the settings ready for JSON."""
        return asdict(self)


def setting(default: object, label: str, description: str, **about: object) -> Any:
    """Return a field of a dataclass that is a setting; for the rest see :class:`Setting`."""
    return field(default=default, metadata={_KEY: Setting(default, label, description, **about)})


def settings_of(
    kind: type[Settings], only: Container[str] | None = None, without: Container[str] = ()
) -> Iterator[Setting]:
    """Yield the settings of a record in their order: all, `only` some or all `without` some, by the names of fields."""
    for one in _all_settings(kind):
        if (only is None or one.name in only) and one.name not in without:
            yield one


def setting_of(kind: type[Settings], name: str) -> Setting:
    """Return one setting by the name of its field; KeyError where there is none."""
    return {one.name: one for one in _all_settings(kind)}[name]


@cache
def _all_settings(kind: type[Settings]) -> tuple[Setting, ...]:
    return tuple(one.metadata[_KEY].named(one.name) for one in fields(kind) if _KEY in one.metadata)


def _documented(one: Setting) -> list[str]:
    """Return the lines of a setting in a docstring."""
    sentences = [one.help or one.description]
    sentences += [f"{_shown(choice.value)}: {choice.description}" for choice in one.choices]
    sentences += [f"None is {one.automatic}"] if one.automatic else []
    sentences += [one.note] if one.note else []
    return [f"{one.name} : {one.type_text}", "    " + " ".join(text.rstrip(".") + "." for text in sentences)]


def _shown(value: object) -> str:
    return "None" if value is None else "a number" if value is float else f'"{value}"'


def _is_number(value: object) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)
