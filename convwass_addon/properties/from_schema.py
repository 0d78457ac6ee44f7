# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender properties generated from the settings of the applications."""

from __future__ import annotations

from collections.abc import Callable, Container, Mapping
from inspect import get_annotations
from math import degrees, radians

from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

from ..schema import Companion, Setting, Settings, setting_of, settings_of

_PATHS = ("DIR_PATH", "FILE_PATH")


def with_properties(
    kind: type[Settings], only: Container[str] | None = None, without: Container[str] = ()
) -> Callable[[type], type]:
    """Return a decorator that annotates a class with the properties of some settings.

    Parameters
    ----------
    kind : type
        The settings class; settings without a property are skipped.
    only, without : container of str
        Names of fields; see :func:`.schema.settings_of`.
    """
    made = {}
    for one in settings_of(kind, only, without):
        made |= _properties(one)

    def annotated(cls: type) -> type:
        # From Python 3.14 on, annotations are not stored in the namespace of the class.
        cls.__annotations__ = made | get_annotations(cls)
        return cls

    return annotated


def property_of(kind: type[Settings], name: str) -> object:
    """Return the property of one setting, for classes that rename it or have no other settings of this kind."""
    (made,) = _properties(setting_of(kind, name)).values()
    return made


def values_of(
    owner: object, kind: type[Settings], only: Container[str] | None = None, without: Container[str] = ()
) -> dict[str, object]:
    """Return the values of settings from an owner's properties, by field name.

    Parameters
    ----------
    owner : bpy.types.PropertyGroup or bpy.types.Operator
        An instance of a class decorated with :func:`with_properties`.
    kind, only, without
        As for :func:`with_properties`.
    """
    return {one.name: _value(owner, one) for one in settings_of(kind, only, without) if one.prop is not None}


def arguments_of(
    values: Mapping[str, object], kind: type[Settings], only: Container[str] | None = None
) -> dict[str, object]:
    """Return the property values, by name, that represent given settings; the inverse of `values_of`.

    Settings without a value are left out. Raises ValueError if a value is not one of the choices.
    """
    found = {}
    for one in settings_of(kind, only):
        if one.prop is not None and one.name in values:
            found |= _arguments(one, values[one.name])
    return found


def _properties(one: Setting) -> dict[str, object]:
    if one.prop is None:
        return {}
    if one.switch is not None:
        switch = BoolProperty(name=one.switch.label, description=one.switch.description)
        return {one.switch.name: switch, one.prop: _number(one, one.switch.start)}
    if one.number is not None:
        return {one.prop: _enum(one), one.number.name: _bound(one.number)}
    if one.choices:
        return {one.prop: _enum(one)}
    return {one.prop: _plain(one)}


def _plain(one: Setting) -> object:
    texts = {"name": one.label, "description": one.description}
    if one.kind is bool:
        return BoolProperty(**texts, default=one.default)
    if one.kind is str:
        options = {"PATH_SUPPORTS_BLEND_RELATIVE"} if one.subtype in _PATHS else set()
        return StringProperty(**texts, default=one.default, subtype=one.subtype, options={"ANIMATABLE"} | options)
    return _number(one, 0.0 if one.default is None else one.default)


def _enum(one: Setting) -> object:
    items = [(choice.identifier, choice.label, choice.description) for choice in one.choices]
    default = one.choice(one.default).identifier
    return EnumProperty(name=one.label, description=one.description, items=items, default=default)


def _bound(companion: Companion) -> object:
    return FloatProperty(name=companion.label, description=companion.description, default=companion.start)


def _number(one: Setting, default: float) -> object:
    limits = {"min": one.least, "max": one.most, "soft_min": one.soft_least, "soft_max": one.soft_most}
    if one.open_ends and not one.zero_is_automatic:
        # Blender's limits are inclusive.
        limits["min"] = one.soft_least
    if one.open_ends and one.most is not None:
        limits["max"] = one.soft_most
    convert = radians if one.subtype == "ANGLE" else lambda number: number
    given = {name: convert(edge) for name, edge in limits.items() if edge is not None}
    given |= {name: getattr(one, name) for name in ("precision", "step") if getattr(one, name) is not None}
    make = IntProperty if one.kind is int else FloatProperty
    return make(name=one.label, description=one.description, default=convert(default), subtype=one.subtype, **given)


def _value(owner: object, one: Setting) -> object:
    given = getattr(owner, one.prop)
    if one.switch is not None:
        return _within(one, given) if getattr(owner, one.switch.name) else None
    if one.choices:
        (choice,) = (choice for choice in one.choices if choice.identifier == given)
        return getattr(owner, one.number.name) if choice.value is float else choice.value
    if one.zero_is_automatic and given == 0.0:
        return None
    if one.subtype == "ANGLE":
        given = degrees(given)
    return _within(one, given) if one.kind is float else given


def _within(one: Setting, number: float) -> float:
    """Clamp a number to its range, which rounding to single precision may have left."""
    if one.least is not None:
        number = max(number, one.least)
    return number if one.most is None else min(number, one.most)


def _arguments(one: Setting, value: object) -> dict[str, object]:
    if one.switch is not None:
        return {one.switch.name: value is not None} | ({} if value is None else {one.prop: value})
    if one.choices:
        choice = one.choice(value)
        return {one.prop: choice.identifier} | ({one.number.name: value} if choice.value is float else {})
    if one.zero_is_automatic and value is None:
        return {one.prop: 0.0}
    return {one.prop: radians(value) if one.subtype == "ANGLE" else value}
