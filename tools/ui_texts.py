# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""All English texts that users see: those registered with Blender and those in the source."""

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
# These modules build errors and sentences from templates that other modules pass in.
_PASS_THROUGH = {"bridge/soft_maps/soft_map_bytes.py", "errors.py", "sentence.py", "translations/__init__.py"}
_ARGUMENTS = {"label": "text", "operator": "text", "prop": "text", "row": "heading", "column": "heading"}


def registered_texts() -> Iterator[str]:
    """Yield the names and descriptions of everything registered; needs the add-on."""
    import bpy

    from convwass_addon import preferences
    from convwass_addon.properties import armatures, densities, light, morph_inputs, recolor, soft_maps

    for name in dir(bpy.types):
        if name.startswith("CONVWASS_PT_"):
            # Blender names the preset popover after the last preset and never shows that name.
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
    """Yield the texts of the properties defined by the add-on, without Blender's own."""
    own = [base for base in cls.__mro__ if base.__module__.startswith("convwass_addon")]
    names = {name for base in own for name in vars(base).get("__annotations__", {}) if name in rna.properties}
    for prop in (rna.properties[name] for name in names):
        yield from (prop.name, prop.description)
        if prop.type == "ENUM":
            for item in prop.enum_items:
                yield from (item.name, item.description)


def source_texts() -> Iterator[str]:
    """Yield the texts that the source passes to Blender or to translation."""
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
    """Yield the user-visible texts in a call."""
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
    """A call that creates a sentence, or an error with a sentence as its message.

    Attributes
    ----------
    call : ast.Call
        The call.
    templates : list of str
        The templates it may use.
    is_literal : bool
        Whether the list is complete: every template is a literal in the call or a constant of the module.
    """

    call: ast.Call
    templates: list[str]
    is_literal: bool


@cache
def messages() -> tuple[tuple[str, Message], ...]:
    """Return the messages of all packages with their places."""
    return tuple(_messages())


def _messages() -> Iterator[tuple[str, Message]]:
    for path in sorted(PACKAGE.rglob("*.py")):
        module = path.relative_to(PACKAGE).as_posix()
        if module not in _PASS_THROUGH:
            for line, message in messages_of(path.read_text(encoding="utf-8")):
                yield f"{module}:{line}", message


def messages_of(source: str) -> Iterator[tuple[int, Message]]:
    """Yield the messages of one module with their lines."""
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
    """Return the expressions that may become the template."""
    if isinstance(node, ast.IfExp):
        return [choice for branch in (node.body, node.orelse) for choice in _choices(branch, constants)]
    if isinstance(node, ast.Name) and node.id in constants:
        return [constants[node.id]]
    if isinstance(node, ast.Subscript) and isinstance(table := constants.get(getattr(node.value, "id", "")), ast.Dict):
        # A key of None means an unpacked table (**table), which is read where it is defined.
        return [value for key, value in zip(table.keys, table.values, strict=True) if key is not None]
    return [node]


def _kinds_of(error: type[ConvwassError]) -> Iterator[type[ConvwassError]]:
    for kind in error.__subclasses__():
        yield from (kind, *_kinds_of(kind))


@cache
def all_texts() -> dict[str, str]:
    """Return all texts, each with one place where it occurs or, for registered texts, an empty string."""
    found = dict.fromkeys((*registered_texts(), *source_texts()), "")
    for place, message in messages():
        found |= dict.fromkeys(message.templates, place)
    found.pop("", None)
    return found
