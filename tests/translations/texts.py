# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""All English texts of the user interface: those that Blender knows by itself, and those in the source."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import convwass_addon
from convwass_addon.applications.health import TEXTS

if TYPE_CHECKING:
    import bpy

PACKAGE = Path(convwass_addon.__file__).parent
ROOMS = ("operators", "panels", "bridge")

_TRANSLATORS = {"rpt_", "tip_", "iface_", "poll_message_set"}
_ARGUMENTS = {"label": "text", "operator": "text", "prop": "text", "row": "heading", "column": "heading"}


def registered_texts() -> Iterator[str]:
    """Yield names and descriptions of all that is registered; needs the add-on."""
    import bpy

    from convwass_addon import preferences, properties

    for name in dir(bpy.types):
        if name.startswith("CONVWASS_PT_"):
            # Blender gives the popover of presets the name of the last one, and does not show it.
            if not hasattr(getattr(bpy.types, name), "preset_subdir"):
                yield getattr(bpy.types, name).bl_label
        elif name.startswith("CONVWASS_OT_"):
            operator = getattr(bpy.ops.convwass, name.removeprefix("CONVWASS_OT_")).get_rna_type()
            yield from (operator.name, operator.description)
            yield from _texts_of_properties(getattr(bpy.types, name), operator)
    for cls in (properties.CONVWASS_PG_input, properties.CONVWASS_PG_morph, preferences.CONVWASS_AP_preferences):
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
    for room in ROOMS:
        for path in sorted((PACKAGE / room).rglob("*.py")):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.Call):
                    yield from _texts_of_call(node)
    yield from (text for text in TEXTS.values() if text != "{text}")
    yield from (path.stem for path in (PACKAGE / "presets").rglob("*.py"))


def _texts_of_call(call: ast.Call) -> Iterator[str]:
    name = call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")
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


def all_texts() -> set[str]:
    """Return all of them; needs the add-on."""
    return {text for text in (*registered_texts(), *source_texts()) if text}
