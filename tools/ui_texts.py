# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""All English texts that users see: those that Blender knows by itself, and those in the source."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import convwass_addon
from convwass_addon.applications.morphs.diagnostics import TEXTS
from convwass_addon.errors import ConvwassError

if TYPE_CHECKING:
    import bpy

PACKAGE = Path(convwass_addon.__file__).parent
PACKAGES = ("operators", "panels", "bridge")

_TRANSLATORS = {"rpt_", "tip_", "iface_", "poll_message_set"}
# They make errors and sentences of templates that come from the others.
_HANDING_ON = {"bridge/soft_maps/soft_map_bytes.py", "errors.py", "sentence.py", "translations/__init__.py"}
_ARGUMENTS = {"label": "text", "operator": "text", "prop": "text", "row": "heading", "column": "heading"}


def registered_texts() -> Iterator[str]:
    """Yield names and descriptions of all that is registered; needs the add-on."""
    import bpy

    from convwass_addon import preferences
    from convwass_addon.properties import armatures, densities, light, morph_inputs, recolor, soft_maps

    for name in dir(bpy.types):
        if name.startswith("CONVWASS_PT_"):
            # Blender gives the popover of presets the name of the last one, and does not show it.
            if not hasattr(getattr(bpy.types, name), "preset_subdir"):
                yield getattr(bpy.types, name).bl_label
        elif name.startswith("CONVWASS_OT_"):
            operator = getattr(bpy.ops.convwass, name.removeprefix("CONVWASS_OT_")).get_rna_type()
            yield from (operator.name, operator.description)
            yield from _texts_of_properties(getattr(bpy.types, name), operator)
    for cls in (
        morph_inputs.CONVWASS_PG_input,
        morph_inputs.CONVWASS_PG_morph,
        densities.CONVWASS_PG_density_stop,
        densities.CONVWASS_PG_densities,
        soft_maps.CONVWASS_PG_map_pair,
        soft_maps.CONVWASS_PG_soft_map,
        armatures.CONVWASS_PG_armature,
        recolor.CONVWASS_PG_recolor,
        light.CONVWASS_PG_reflectance,
        light.CONVWASS_PG_sky,
        preferences.CONVWASS_AP_preferences,
    ):
        yield from _texts_of_properties(cls, cls.bl_rna)


def _texts_of_properties(cls: type, rna: bpy.types.Struct) -> Iterator[str]:
    """Yield the texts of the properties that the add-on has defined, not Blender."""
    own = [base for base in cls.__mro__ if base.__module__.startswith("convwass_addon")]
    names = {name for base in own for name in vars(base).get("__annotations__", {}) if name in rna.properties}
    for prop in (rna.properties[name] for name in names):
        yield from (prop.name, prop.description)
        if prop.type == "ENUM":
            for item in prop.enum_items:
                yield from (item.name, item.description)


def source_texts() -> Iterator[str]:
    """Yield the texts that the source hands to Blender or to its translation."""
    for package in PACKAGES:
        for path in sorted((PACKAGE / package).rglob("*.py")):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.Call):
                    yield from texts_of_call(node)
    yield from TEXTS.values()
    yield from (path.stem for path in (PACKAGE / "presets").rglob("*.py"))


def _name(call: ast.Call) -> str:
    return call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")


def texts_of_call(call: ast.Call) -> Iterator[str]:
    """Yield the texts for users that stand in a call."""
    name = _name(call)
    if name in _TRANSLATORS and call.args:
        yield from _literal(call.args[0])
    if name == "report" and len(call.args) == 2:
        yield from _literal(call.args[1])
    if not any(keyword.arg == "translate" for keyword in call.keywords):
        for keyword in call.keywords:
            if keyword.arg == _ARGUMENTS.get(name):
                yield from _literal(keyword.value)


def _literal(node: ast.expr) -> Iterator[str]:
    if isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value:
        yield node.value


@dataclass(frozen=True)
class Message:
    """Where a sentence is made, or an error whose message is one.

    Attributes
    ----------
    call : ast.Call
        How.
    templates : list of str
        Those that it may be made of.
    is_literal : bool
        Whether these are all, written out there or in a constant of the same module.
    """

    call: ast.Call
    templates: list[str]
    is_literal: bool


@cache
def messages() -> tuple[tuple[str, Message], ...]:
    """Return all texts of all packages with their places."""
    return tuple(_messages())


def _messages() -> Iterator[tuple[str, Message]]:
    for path in sorted(PACKAGE.rglob("*.py")):
        module = path.relative_to(PACKAGE).as_posix()
        if module not in _HANDING_ON:
            for line, message in messages_of(path.read_text(encoding="utf-8")):
                yield f"{module}:{line}", message


def messages_of(source: str) -> Iterator[tuple[int, Message]]:
    """Yield those of one module with their lines."""
    tree = ast.parse(source)
    names = {kind.__name__ for kind in (ConvwassError, *_kinds_of(ConvwassError))} | {"Sentence"}
    constants: dict[str, ast.expr] = {}
    for node in tree.body:
        if isinstance(node, (ast.Assign, ast.AnnAssign)) and node.value is not None:
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            constants |= {target.id: node.value for target in targets if isinstance(target, ast.Name)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and _name(node) in names:
            choices = _choices(node.args[0], constants) if node.args else []
            texts = [[*_literal(choice)] for choice in choices]
            yield node.lineno, Message(node, [text for own in texts for text in own], bool(texts) and all(texts))


def _choices(node: ast.expr, constants: dict[str, ast.expr]) -> list[ast.expr]:
    """Return the expressions of which one becomes the template."""
    if isinstance(node, ast.IfExp):
        return [choice for branch in (node.body, node.orelse) for choice in _choices(branch, constants)]
    if isinstance(node, ast.Name) and node.id in constants:
        return [constants[node.id]]
    if isinstance(node, ast.Subscript) and isinstance(table := constants.get(getattr(node.value, "id", "")), ast.Dict):
        # A key of None stands before a table from elsewhere, which is read there.
        return [value for key, value in zip(table.keys, table.values, strict=True) if key is not None]
    return [node]


def _kinds_of(error: type[ConvwassError]) -> Iterator[type[ConvwassError]]:
    for kind in error.__subclasses__():
        yield from (kind, *_kinds_of(kind))


@cache
def all_texts() -> dict[str, str]:
    """Return all of them with a place where each stands, empty where Blender knows it by itself; needs the add-on."""
    found = dict.fromkeys((*registered_texts(), *source_texts()), "")
    for place, message in messages():
        found |= dict.fromkeys(message.templates, place)
    found.pop("", None)
    return found
