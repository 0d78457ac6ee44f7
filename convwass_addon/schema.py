# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings that are declared once, as fields of a dataclass, and used by all layers.

A setting is one line::

    @dataclass(frozen=True)
    class BrushSettings(Settings):
        \"\"\"How a brush paints.\"\"\"

        radius: float = setting(0.1, "Radius", "How far the brush reaches", least=0.0, most=10.0)

It defines the validation of the value, the property in Blender (:mod:`.properties.from_schema`), the command-line
option (:mod:`.cli.from_schema`), the panel row (:mod:`.panels.from_schema`), the stored entry
(:meth:`Settings.as_dict`), and the docstring, which is shown in the API reference.
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
    """One of the values of a setting.

    Attributes
    ----------
    value : str, None or the type float
        In the dataclass; `float` represents any number.
    label, description : str
        For users.
    identifier : str
        In Blender; by default the value in upper case, "OFF" for None, "NUMBER" for any number.
    word : str
        On the command line; by default the value in lower case, "off" for None, "NUMBER" for any number.
    """

    value: str | type[float] | None
    label: str
    description: str
    identifier: str = ""
    word: str = ""

    def __post_init__(self) -> None:
        """Derive the identifier and word if they are not given."""
        name = "off" if self.value is None else "number" if self.value is float else str(self.value)
        word = "NUMBER" if self.value is float else name.lower().replace("_", "-")
        object.__setattr__(self, "identifier", self.identifier or name.upper().replace("-", "_"))
        object.__setattr__(self, "word", self.word or word)


@dataclass(frozen=True)
class Companion:
    """A second Blender property for a setting, since a Blender property has a single type and cannot be None.

    Attributes
    ----------
    name, label, description : str
        Texts of the property.
    start : float
        Initial value in Blender.
    """

    name: str
    label: str
    description: str
    start: float


@dataclass(frozen=True)
class Setting:
    """Description of a setting.

    Attributes
    ----------
    default : object
        None if the value is chosen automatically; see `automatic`.
    label : str
        Name for users, in title case.
    description : str
        Meaning of the setting, in the style of Blender's tooltips: no leading article, no final full stop. Also used in
        the command-line help and the API reference.
    name : str
        Name of the field, set by :func:`settings_of`.
    least, most : float or None
        Range of a number.
    open_ends : bool
        Whether the ends of the range are excluded.
    soft_least, soft_most : float or None
        Slider range in Blender; with `open_ends`, also the range of the property.
    unit : str
        Unit of a number, such as "cells", for the API reference.
    subtype : str
        Subtype in Blender: "FACTOR", "DISTANCE", "PIXEL", "DIR_PATH" and so on. "ANGLE" is in degrees here.
    precision, step : float or None
        In Blender: number of decimals, and step of the arrow buttons.
    choices : tuple of Choice
        The allowed values; one of them can be any number.
    automatic : str
        Meaning of None.
    switch : Companion or None
        For a number that may be None: the property that enables the number.
    number : Companion or None
        For a setting with any number as one choice: the property of the number.
    zero_is_automatic : bool
        Whether 0 in Blender means None.
    prop : str or None
        Name in Blender, by default that of the field; None if there is no such property.
    option : str or None
        Name on the command line, by default that of the field with hyphens; None if there is no such option.
    flag : str or None
        For a setting with choices: the option is a flag that selects this value.
    help : str
        Replaces the description on the command line and in scripts, if the description refers to Blender.
    note : str
        Additional information for scripts, for the API reference.
    panel : str
        The panel that shows the setting, if the panel is generated from the schema.
    applies_when : tuple of str
        Name and required value of another setting on which this one depends; () if independent.
    preset : bool
        Whether solver presets include the setting.
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
        """Return the setting with its field name and the names derived from it."""
        option = "--" + name.replace("_", "-") if self.option == "" else self.option
        return replace(self, name=name, prop=name if self.prop == "" else self.prop, option=option)

    @property
    def kind(self) -> type:
        """The value type: bool, int, float or str; float for numbers that may be None."""
        if self.choices:
            return str
        return float if self.default is None else type(self.default)

    @property
    def properties(self) -> tuple[str, ...]:
        """The names of its Blender properties."""
        if self.prop is None:
            return ()
        return (*(one.name for one in (self.switch, self.number) if one), self.prop)

    def choice(self, value: object) -> Choice:
        """Return the choice for a value or an identifier; raises ValueError if there is none."""
        for choice in self.choices:
            if choice.value is not float and value in (choice.value, choice.identifier):
                return choice
        if _is_number(value):
            for choice in self.choices:
                if choice.value is float:
                    return choice
        raise ValueError(f"{self.name} is {value!r}")

    def check(self, value: object) -> None:
        """Validate a value.

        Raises
        ------
        InputError
            Contains the label and the allowed values.
        """
        if self.choices:
            self._check_choice(value)
        elif self.kind is bool:
            if value not in (True, False):
                raise InputError("{name} must be on or off, not {value!r}.", name=self._said(), value=value)
        elif self.kind in (int, float) and not (value is None and self.default is None):
            self._check_number(value)

    def _said(self) -> Sentence:
        """Return the label, followed by the field name if it differs, for users of scripts."""
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
        """The range of a number as text; empty if unlimited."""
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
        """The type as in a docstring, with its range."""
        if self.choices:
            *most, last = (_shown(choice.value) for choice in self.choices)
            return f"{', '.join(most)} or {last}" if most else last
        parts = [self.kind.__name__ + (" or None" if self.default is None else ""), self.range_text]
        return ", ".join(filter(None, parts))


class Settings:
    """Base of settings classes: values are validated on creation, and the docstring lists the fields."""

    def __init_subclass__(cls, **options: object) -> None:
        """Append the settings to the class's docstring, to its Attributes section if there is one."""
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
        """Validate all values.

        Raises
        ------
        InputError
            Contains the label of the setting and its allowed values.
        """
        for one in settings_of(type(self)):
            one.check(getattr(self, one.name))

    def as_dict(self) -> dict[str, object]:
        """Return the settings as a dict for JSON."""
        return asdict(self)


def setting(default: object, label: str, description: str, **about: object) -> Any:
    """Return a dataclass field that defines a setting; for `about` see :class:`Setting`."""
    return field(default=default, metadata={_KEY: Setting(default, label, description, **about)})


def settings_of(
    kind: type[Settings], only: Container[str] | None = None, without: Container[str] = ()
) -> Iterator[Setting]:
    """Yield the settings of a class in order, `only` or `without` some field names."""
    for one in _all_settings(kind):
        if (only is None or one.name in only) and one.name not in without:
            yield one


def setting_of(kind: type[Settings], name: str) -> Setting:
    """Return a setting by field name; raises KeyError if there is none."""
    return {one.name: one for one in _all_settings(kind)}[name]


@cache
def _all_settings(kind: type[Settings]) -> tuple[Setting, ...]:
    return tuple(one.metadata[_KEY].named(one.name) for one in fields(kind) if _KEY in one.metadata)


def _documented(one: Setting) -> list[str]:
    """Return the docstring lines of a setting."""
    sentences = [one.help or one.description]
    sentences += [f"{_shown(choice.value)}: {choice.description}" for choice in one.choices]
    sentences += [f"None is {one.automatic}"] if one.automatic else []
    sentences += [one.note] if one.note else []
    return [f"{one.name} : {one.type_text}", "    " + " ".join(text.rstrip(".") + "." for text in sentences)]


def _shown(value: object) -> str:
    return "None" if value is None else "a number" if value is float else f'"{value}"'


def _is_number(value: object) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)
