# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a file shows at its frames, as numbers: equal with the extension, without it and with its next version.

Imports nothing from the project: it runs in Blender sessions that never had the extension.
"""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np

FRAMES = (1, 2, 3, 4)


def figures() -> dict[str, dict[str, list[float]]]:
    """Return the evaluated state of every object, material and world at every frame, rounded.

    Returns
    -------
    dict
        Numbers by frame and name: for objects their visibility in viewport and renders, and the counts and sums of
        evaluated positions and attributes; for node trees the values of their sockets; for drivers whether they are
        valid.
    """
    scene = bpy.context.scene
    found: dict[str, dict[str, list[float]]] = {}
    for frame in FRAMES:
        scene.frame_set(frame)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        seen = {obj.name: _of_object(obj, depsgraph) for obj in sorted(scene.objects, key=lambda obj: obj.name)}
        for kind in ("materials", "worlds"):
            for block in getattr(bpy.data, kind):
                # Unused data-blocks are not saved.
                if block.node_tree is not None and block.users:
                    seen[f"{kind} {block.name}"] = _of_tree(block.node_tree)
        found[str(frame)] = seen
    return found


def leftovers() -> dict[str, list[str]]:
    """Return everything in the file that would fail without the extension.

    Returns
    -------
    dict
        Scripts in the file, missing data, drivers that fail or run Python, images without pixels.
    """
    drivers = [
        driver
        for kind in ("objects", "node_groups", "scenes")
        for block in getattr(bpy.data, kind)
        if block.animation_data
        for driver in block.animation_data.drivers
    ]
    for owner in (*bpy.data.materials, *bpy.data.worlds):
        if owner.node_tree is not None and owner.node_tree.animation_data:
            drivers += owner.node_tree.animation_data.drivers
    scripted = (d for d in drivers if d.driver.type == "SCRIPTED" and not d.driver.is_simple_expression)
    return {
        "texts": bpy.data.texts.keys(),
        "handlers": [call.__module__ for call in _handlers() if "convwass" in call.__module__],
        "python drivers": [driver.data_path for driver in scripted],
        "broken drivers": [driver.data_path for driver in drivers if not driver.is_valid or not driver.driver.is_valid],
        "missing data": [block.name for block in bpy.data.user_map() if getattr(block, "is_missing", False)],
        "undefined nodes": [
            f"{tree.name}: {node.name}"
            for tree in (*bpy.data.node_groups, *(m.node_tree for m in bpy.data.materials if m.node_tree))
            for node in tree.nodes
            if node.bl_idname == "NodeUndefined"
        ],
        "empty images": [image.name for image in bpy.data.images if image.users and not _has_pixels(image)],
    }


def _handlers() -> list:
    lists = (getattr(bpy.app.handlers, name) for name in dir(bpy.app.handlers))
    return [call for calls in lists if isinstance(calls, list) for call in calls]


def _has_pixels(image: bpy.types.Image) -> bool:
    if image.source in ("SEQUENCE", "MOVIE"):  # which have pixels only while shown
        return Path(bpy.path.abspath(image.filepath)).is_file()
    return image.source == "VIEWER" or len(image.pixels) > 0


def _of_object(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> list[float]:
    numbers = [float(obj.hide_viewport), float(obj.hide_render)]
    evaluated = obj.evaluated_get(depsgraph)
    if obj.type == "VOLUME":
        grids = evaluated.data.grids
        grids.load()
        return [*numbers, float(len(grids)), *_rounded(np.ravel(evaluated.bound_box))]
    if obj.type not in ("MESH", "CURVE", "FONT"):
        return [*numbers, *_rounded(np.ravel(obj.matrix_world))]
    if obj.type != "MESH" and obj.hide_viewport:
        # Blender fills a hidden curve or not, depending on what it showed before.
        return numbers
    mesh = evaluated.to_mesh()
    if mesh is not None:
        points = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.vertices.foreach_get("co", points)
        places = points.reshape(-1, 3).astype(np.float64)
        numbers += [float(len(places)), float(len(mesh.polygons))]
        numbers += _rounded([*places.sum(axis=0), *np.square(places).sum(axis=0)])
        numbers += [_sum_of(attribute) for attribute in mesh.attributes if _is_shown(attribute)]
    evaluated.to_mesh_clear()
    return numbers


def _is_shown(attribute: bpy.types.Attribute) -> bool:
    return attribute.data_type in ("FLOAT", "FLOAT_COLOR", "BYTE_COLOR") and not attribute.name.startswith(".")


def _sum_of(attribute: bpy.types.Attribute) -> float:
    width, name = (1, "value") if attribute.data_type == "FLOAT" else (4, "color")
    values = np.empty(width * len(attribute.data), np.float32)
    attribute.data.foreach_get(name, values)
    return _rounded([float(values.sum(dtype=np.float64))])[0]


def _of_tree(tree: bpy.types.NodeTree) -> list[float]:
    numbers = [float(len(tree.nodes)), float(len(tree.links))]
    for node in tree.nodes:
        for socket in node.inputs:
            value = getattr(socket, "default_value", 0.0)
            if isinstance(value, (bool, int, float)):
                numbers += _rounded([value])
            elif hasattr(value, "__len__") and not isinstance(value, str):
                numbers += _rounded(list(value))
        image = getattr(node, "image", None)
        if image is not None and image.source != "SEQUENCE":
            numbers += [float(side) for side in image.size]
    return numbers


def _rounded(values) -> list[float]:
    # Sums of float32 may depend on the order of summation, which graphics cards and processors choose differently.
    return [float(f"{float(value):.4g}") for value in values]
