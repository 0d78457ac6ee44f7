# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes to morph, and what is in a file before and after that."""

from __future__ import annotations

import inspect
from functools import partial
from types import MethodType

import bpy

from convwass_addon.applications.motions.guided_settings import GuidedSettings
from convwass_addon.bridge.one_mesh import shape_key_job
from convwass_addon.operators.morph_bake import CONVWASS_OT_bake_morph

_KINDS = ("objects", "meshes", "curves", "collections", "materials", "actions", "scenes", "node_groups", "images")


def add(kind, name=None, **options):
    """Add a mesh, which is active and selected."""
    getattr(bpy.ops.mesh, f"primitive_{kind}_add")(**options)
    obj = bpy.context.object
    obj.name = name or obj.name
    return obj


def two_shapes():
    cube = add("cube", size=2, location=(-3, 0, 0))
    ball = add("uv_sphere", segments=24, ring_count=12, location=(3, 0, 1))
    cube.select_set(True)
    return cube, ball


def two_balls():
    """Add two equal balls to a scene that is otherwise empty, and select them."""
    for x in (0.0, 3.0):
        add("ico_sphere", subdivisions=2, location=(x, 0, 0))
    bpy.ops.object.select_all(action="SELECT")


def baked_morph():
    """Return the collection of a bake."""
    return next(c for c in bpy.data.collections if c.name.startswith("Morph"))


def guide_coarsely(monkeypatch):
    """Let bakes of shape keys map and deform shapes on coarse meshes."""
    coarse = partial(GuidedSettings, map_vertices=100, carrier_vertices=200)
    monkeypatch.setattr(shape_key_job, "GuidedSettings", coarse)


def census():
    """Return the names of everything that operators could leave behind, by kind; of shape keys only the number."""
    names = {kind: sorted(block.name for block in getattr(bpy.data, kind)) for kind in _KINDS}
    return {**names, "shape_keys": len(bpy.data.shape_keys)}


class PressedBake:
    """Bake Morph between two events: its own methods, and the scene's settings as its properties."""

    inputs = weights = guides = ""

    def __init__(self):
        self.reports = []
        self.replaces = self.following = ""

    def report(self, kind, message):
        self.reports.append(message)

    def __getattr__(self, name):
        found = inspect.getattr_static(CONVWASS_OT_bake_morph, name, None)
        if inspect.isfunction(found):
            return MethodType(found, self)
        # Constants of the operator are private, unlike its settings.
        is_constant = name.startswith("_") and found is not None
        return found if is_constant else getattr(bpy.context.scene.convwass_morph, name)
