# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Unusual values for the properties of operators and scenes."""

from __future__ import annotations

import math
from random import Random

import bpy

# Properties that determine the amount of work are kept small, to have time for everything else.
CHEAP = {
    "resolution": (16, 24),
    "flat_resolution": (256, 256),
    "frames": (2, 4),
    "steps": (1, 4),
    "blends": (2, 3),
    "detail": (8, 10),
    "width": (64, 64),
    "size": (16, 64),
    "margin": (0, 4),
    "cube_size": (2, 5),
    "vertices": (50, 60),
    "sweeps": (1, 2),
    "max_iterations": (1, 40),
    "edge_radius": (0, 5),
    "links": (1, 4),
}
NUMBERS = (
    "nan",
    "inf, 1",
    "-1",
    "1e400, 0",
    "0, 0",
    "1",
    "0.5, 0.5",
    "3, 2, 1",
    "0:0, 1:1",
    "5:999999",
    "0:",
    ":::",
    "1-2",
)
ODD = (
    "",
    " ",
    ",",
    "\n",
    "ä ö ü 日本語 🦆",
    "{x}",
    "{0}",
    "{a.b}",
    "%s %d",
    "x" * 5000,
    "a\tb",
    "'\"\\",
    "..",
    "None",
    "\u202e",
)
PATHS = (
    "",
    "//",
    "//beside",
    "new/deep/er",
    "/proc/none",
    "/dev/null/below",
    "/dev/full",
    "~nobody_at_all/x",
    "x" * 300,
    "d/" * 3000,
    ".",
    "file.npz",
    "file.cube",
    "ü 日本/🦆",
)
PATH_NAMES = {"folder", "filepath", "table"}


def arguments(properties: object, random: Random) -> dict[str, object]:
    """Return some of the arguments of an operator, most of them invalid."""
    found = {}
    for prop in properties:
        if prop.identifier == "rna_type" or prop.is_readonly:
            continue
        is_costly = prop.identifier in CHEAP
        if is_costly or random.random() < 0.4:
            found[prop.identifier] = value(prop, random)
    return found


def value(prop: object, random: Random) -> object:
    """Return a value of a property's type."""
    if prop.type in ("INT", "FLOAT", "BOOLEAN") and prop.is_array:
        return tuple(_single(prop, random) for _ in range(prop.array_length))
    return _single(prop, random)


def _single(prop: object, random: Random) -> object:
    if prop.type == "BOOLEAN":
        return random.random() < 0.5
    if prop.type == "INT":
        if prop.identifier in CHEAP:
            return random.randint(*CHEAP[prop.identifier])
        return random.choice((prop.hard_min, prop.hard_max, 0, 1, 2, 3, -1, random.randint(0, 30)))
    if prop.type == "FLOAT":
        wild = (prop.hard_min, prop.hard_max, 0.0, -0.0, 1.0, math.nan, math.inf, -math.inf, 1e-30, 1e30, 0.1)
        return random.choice((*wild, random.uniform(max(prop.soft_min, -10), min(prop.soft_max, 10))))
    if prop.type == "ENUM":
        return random.choice([item.identifier for item in prop.enum_items])
    if prop.identifier in PATH_NAMES:
        return random.choice(PATHS)
    return text(random)


def text(random: Random) -> str:
    """Return names from the file, numbers, or nonsense."""
    kind = random.random()
    if kind < 0.25:
        return ""
    if kind < 0.4:
        return random.choice(ODD)
    if kind < 0.55:
        return random.choice(NUMBERS)
    names = [block.name for block in bpy.data.user_map() if block.id_type in ("OBJECT", "MATERIAL", "IMAGE", "WORLD")]
    names += [group.name for obj in bpy.data.objects if obj.type == "MESH" for group in obj.vertex_groups]
    names += [collection.name for collection in bpy.data.collections] + ["A", "B"]
    count = random.choice((1, 1, 2, 2, 3))
    return random.choice((", ", ",", "\n")).join(random.choice(names) for _ in range(count))


def stir(group: object, random: Random) -> None:
    """Change properties stored in the scene or an object."""
    for prop in group.bl_rna.properties:
        if prop.identifier in ("rna_type", "name") or prop.is_readonly:
            continue
        if prop.identifier not in CHEAP and random.random() < 0.6:
            continue
        if prop.type == "POINTER":
            setattr(group, prop.identifier, _pointed(prop, random, group))
        elif prop.type != "COLLECTION":
            setattr(group, prop.identifier, value(prop, random))


def _pointed(prop: object, random: Random, group: object) -> object:
    collections = {"Object": "objects", "Image": "images", "Material": "materials", "World": "worlds"}
    if prop.fixed_type.identifier not in collections or random.random() < 0.15:
        return None
    blocks = list(getattr(bpy.data, collections[prop.fixed_type.identifier]))
    return random.choice(blocks) if blocks else None
