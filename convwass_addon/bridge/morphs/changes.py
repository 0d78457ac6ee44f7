# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Detect changes of the shapes of a morph since its bake, without evaluating them."""

from __future__ import annotations

import json
import math

import bpy

from ...errors import ConvwassError
from ..shape_sources import OBJECTS, ShapeSource, shape_sources
from ..visibility import is_enabled
from .stored import stored_morph

SIGNATURES_KEY = "convwass_signatures"
"""Custom property of a morph's collection: JSON of one signature per input."""

# Allows for single precision, and for saving and loading the scene.
_TOLERANCE = 1e-5
# The first numbers of a signature, which do not depend on evaluation: counts of mesh elements and of modifiers.
_UNEVALUATED = 3


def store_signatures(block: bpy.types.Collection | bpy.types.Object, signatures: list[list[float]]) -> None:
    """Store the signatures of a morph's inputs with it."""
    finite = [[number if math.isfinite(number) else 0.0 for number in one] for one in signatures]
    block[SIGNATURES_KEY] = json.dumps(finite)


def signature(source: ShapeSource) -> list[float]:
    """Return numbers that change if a shape is moved, reshaped or gets other modifiers.

    They are available without evaluation, so that panels can compare them: mesh counts, evaluated bounds, and the
    transform. An edit that preserves all of them is not detected.
    """
    of_parts = [_signature(part) for part in source.parts]
    # What is moved from one part to another must not cancel out.
    return [float(sum(place * number for place, number in enumerate(own, 1))) for own in zip(*of_parts, strict=True)]


def _signature(obj: bpy.types.Object) -> list[float]:
    counts = _counts(obj)
    bounds = [coordinate for corner in (obj.bound_box[0], obj.bound_box[6]) for coordinate in corner]
    place = [number for row in obj.matrix_world for number in row]
    return [float(number) for number in (*counts, len(obj.modifiers), *bounds, *place)]


def _counts(obj: bpy.types.Object) -> list[int]:
    """Return two characteristic counts of an object's data."""
    if obj.type == "MESH":
        return [len(obj.data.vertices), len(obj.data.polygons)]
    if obj.type == "FONT":
        return [len(obj.data.body), sum(place * ord(sign) for place, sign in enumerate(obj.data.body, 1))]
    if obj.type == "CURVE":
        return [len(obj.data.splines), sum(len(own.bezier_points) + len(own.points) for own in obj.data.splines)]
    return [0, 0]


def changed_inputs(block: bpy.types.Collection | bpy.types.Object) -> list[str]:
    """Return the names of inputs that are missing or have changed; empty if unknown."""
    try:
        known = json.loads(block.get(SIGNATURES_KEY, "[]"))
        stored = stored_morph(block)
        grouping = stored.settings.get("grouping", OBJECTS)
    except (ValueError, TypeError, RecursionError, ConvwassError):
        # A damaged description is reported where it is used.
        return []
    if not isinstance(known, list) or len(known) != len(stored.inputs):
        return []
    there = [obj for obj in stored.objects if obj is not None]
    sources = dict(zip(there, shape_sources(there, grouping), strict=True))
    compared = zip(stored.inputs, stored.objects, known, strict=True)
    changed = (name for name, obj, before in compared if obj is None or not _is_as_before(sources[obj], before))
    return list(dict.fromkeys(changed))


def _is_as_before(source: ShapeSource, before: object) -> bool:
    now = signature(source)
    if not (isinstance(before, list) and len(before) == len(now)):
        return True
    if not all(isinstance(number, (int, float)) for number in before):
        return True
    if not all(map(_is_evaluated, source.parts)):
        now, before = now[:_UNEVALUATED], before[:_UNEVALUATED]
    return all(math.isclose(a, b, rel_tol=_TOLERANCE, abs_tol=_TOLERANCE) for a, b in zip(now, before, strict=True))


def _is_evaluated(obj: bpy.types.Object) -> bool:
    """Return whether Blender keeps the bounds and the transform of an object current, also after a file is opened."""
    return not obj.hide_viewport and is_enabled(obj, bpy.context.view_layer)
