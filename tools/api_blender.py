# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Markdown pages about operators, scene settings and the command line."""

from __future__ import annotations

from argparse import SUPPRESS, Action, ArgumentParser

import bpy

from convwass_addon import operators
from convwass_addon.cli import program

# A property that every operator inherits from Blender.
_USUAL = ("rna_type",)
_UNBOUNDED = 1e9


def operator_pages() -> dict[str, list[str]]:
    """Return the Markdown of every operator by name; the add-on must be registered."""
    kinds = [kind for module in operators._MODULES for kind in module.classes if issubclass(kind, bpy.types.Operator)]
    return {kind.bl_idname: _operator(kind.bl_idname) for kind in kinds}


def _operator(name: str) -> list[str]:
    kind = getattr(bpy.ops.convwass, name.partition(".")[2]).get_rna_type()
    rows = [_row(prop) for prop in kind.properties if prop.identifier not in _USUAL]
    lines = [f"*{_cell(kind.name)}.* {_cell(kind.description)}."]
    return [*lines, "", *_table(("Argument", "Default", "Values", "Meaning"), rows)] if rows else lines


def scene_pages() -> dict[str, list[str]]:
    """Return the Markdown of the settings that every scene keeps for the panels, by name."""
    groups = [prop for prop in bpy.types.Scene.bl_rna.properties if prop.identifier.startswith("convwass_")]
    found = {}
    for group in groups:
        rows = [_row(prop) for prop in group.fixed_type.properties if prop.identifier not in ("rna_type", "name")]
        found[group.identifier] = _table(("Property", "Default", "Values", "Meaning"), rows)
    return found


def _row(prop: bpy.types.Property) -> tuple[str, ...]:
    meaning = prop.description or prop.name
    return f"`{prop.identifier}`", _default(prop), _values(prop), _cell(meaning)


def _default(prop: bpy.types.Property) -> str:
    if prop.type in ("POINTER", "COLLECTION"):
        return ""
    if prop.type == "ENUM":
        shown: object = set(prop.default_flag) if prop.is_enum_flag else prop.default
        return f"`{_listed(shown) if isinstance(shown, set) else repr(shown)}`"
    if prop.type in ("INT", "FLOAT", "BOOLEAN") and prop.is_array:
        return f"`({', '.join(_number(value) for value in prop.default_array)})`"
    return f"`{_number(prop.default)}`" if prop.type == "FLOAT" else f"`{prop.default!r}`"


def _listed(names: set[str]) -> str:
    return "{" + ", ".join(repr(name) for name in sorted(names)) + "}"


def _values(prop: bpy.types.Property) -> str:
    if prop.type == "ENUM":
        # Dynamic enum items depend on the scene.
        return ", ".join(f"`{item.identifier}`" for item in prop.enum_items_static)
    if prop.type in ("INT", "FLOAT"):
        low, high = (None if abs(edge) >= _UNBOUNDED else _number(edge) for edge in (prop.hard_min, prop.hard_max))
        unit = " radians" if prop.subtype == "ANGLE" else ""
        if low is not None and high is not None:
            return f"{low} to {high}{unit}"
        return f"from {low}{unit}" if low is not None else f"up to {high}{unit}" if high is not None else unit.strip()
    if prop.type in ("POINTER", "COLLECTION"):
        return prop.fixed_type.name + ("s" if prop.type == "COLLECTION" else "")
    return {"BOOLEAN": "True, False", "STRING": "text"}[prop.type]


def _number(value: float) -> str:
    return str(value) if isinstance(value, int) else f"{value:.6g}"


def command_pages() -> dict[str, list[str]]:
    """Return the Markdown of every command by name."""
    found = {}
    for command in program.COMMANDS:
        parser = ArgumentParser(command.name, add_help=False)
        command.add_options(parser)
        found[command.name] = _command_page(command.name, command.description, parser)
    return found


def _command_page(name: str, description: str, parser: ArgumentParser) -> list[str]:
    lines = ["```text", description.strip(), "```"]
    for group in parser._action_groups:
        actions = [action for action in group._group_actions if action.help is not SUPPRESS]
        if actions:
            title = {"positional arguments": "Arguments", "options": "Options"}.get(group.title, group.title)
            rows = [("`" + _usage(action).replace("|", "\\|") + "`", _help(action, name)) for action in actions]
            lines += ["", *_table((title[0].upper() + title[1:], "Meaning"), rows)]
    return lines


def _usage(action: Action) -> str:
    if action.nargs == 0:
        return ", ".join(action.option_strings)
    metavar = action.metavar or ("{" + ",".join(map(str, action.choices)) + "}" if action.choices else None)
    word = metavar or (action.dest.upper() if action.option_strings else action.dest)
    word = {"*": f"[{word} …]", "+": f"{word} [{word} …]", "?": f"[{word}]"}.get(action.nargs, word)
    if isinstance(action.nargs, int):
        word = " ".join([word] * action.nargs)
    return " ".join([*action.option_strings[-1:], word])


def _help(action: Action, program: str) -> str:
    return _cell((action.help or "") % {**vars(action), "prog": program})


def _table(heads: tuple[str, ...], rows: list[tuple[str, ...]]) -> list[str]:
    lines = [heads, ("---",) * len(heads), *rows]
    return ["| " + " | ".join(cells) + " |" for cells in lines]


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|").replace("<", "\\<").replace("*", "\\*")
