# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw the picture of looks that are carried along, docs/pictures/looks.jpg: ``PYTHONPATH=. python docs/looks.py``."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
import numpy as np
from numpy.typing import NDArray

import convwass_addon
from convwass_addon.bridge.imports import import_objects
from convwass_addon.bridge.morphs.contact_sheet import render_contact_sheet

PROJECT = Path(__file__).resolve().parents[1]
_SPOTS = 26


def main() -> None:
    """Paint two shapes, morph them and render the way from one to the other."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    convwass_addon.register()
    for name, paint in (("horse", _spotted), ("bird", _banded)):
        (obj,) = import_objects(PROJECT / "assets" / "shapes" / f"{name}.ply", None)
        modifier = obj.modifiers.new("Finer", "SUBSURF")
        modifier.levels = 2
        bpy.context.view_layer.objects.active = obj
        obj.select_set(True)
        bpy.ops.object.modifier_apply(modifier=modifier.name)
        _paint(obj, paint)
    bpy.ops.convwass.bake_morph(frames=4, resolution=128, reverse=True)
    morph = next(collection for collection in bpy.data.collections if collection.name.startswith("Morph"))
    with TemporaryDirectory() as folder:
        picture = bpy.data.images.load(str(render_contact_sheet(morph, Path(folder) / "looks.png")))
        picture.file_format = "JPEG"
        picture.save(filepath=str(PROJECT / "docs" / "pictures" / "looks.jpg"), quality=88)


def _paint(obj: bpy.types.Object, paint: Callable[[NDArray[np.float32]], NDArray[np.float64]]) -> None:
    """Give an object colors by the places of its vertices, and a material that shows them."""
    mesh = obj.data
    mesh.shade_smooth()
    points = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", points)
    colors = np.ones((len(mesh.vertices), 4), dtype=np.float32)
    colors[:, :3] = paint(points.reshape(-1, 3))
    attribute = mesh.color_attributes.new("Paint", "FLOAT_COLOR", "POINT")
    attribute.data.foreach_set("color", colors.ravel())
    material = bpy.data.materials.new(obj.name)
    if material.node_tree is None:  # Blender 4.5
        material.use_nodes = True
    nodes = material.node_tree.nodes
    shader = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    source = nodes.new("ShaderNodeVertexColor")
    source.layer_name = "Paint"
    material.node_tree.links.new(source.outputs["Color"], shader.inputs["Base Color"])
    mesh.materials.clear()
    mesh.materials.append(material)


def _spotted(points: NDArray[np.float32]) -> NDArray[np.float64]:
    rng = np.random.default_rng(11)
    centers = points[rng.choice(len(points), _SPOTS, replace=False)]
    reach = rng.uniform(0.07, 0.16, _SPOTS)
    depth = (np.linalg.norm(points[:, None] - centers, axis=2) - reach).min(axis=1)
    inside = np.clip(0.5 - depth / 0.02, 0.0, 1.0)[:, None]
    return inside * [0.16, 0.06, 0.03] + (1.0 - inside) * [0.9, 0.84, 0.74]


def _banded(points: NDArray[np.float32]) -> NDArray[np.float64]:
    wave = np.clip(0.5 + 3.0 * np.sin(14.0 * points[:, 1]), 0.0, 1.0)[:, None]
    return wave * [0.05, 0.22, 0.55] + (1.0 - wave) * [0.85, 0.6, 0.1]


if __name__ == "__main__":
    main()
