# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Create materials that show blended lobes: as tables, or by the best fitting Principled BSDF."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.reflectance.materials import Ggx
from ..keyframes import clear_animation, curves_of, make_linear
from ..last_result import last_result
from ..node_trees import own_tree
from .frame_span import Frames
from .lobe_images import lobe_image
from .lobe_nodes import BLEND, DIFFUSE, DIRECTION, GROUP, LIGHT, STRENGTH, lobe_group

RESULT_OF = "convwass_lobes"
"""Custom property of a result: the source materials and the way of showing the blend."""

# A lamp shines along its Z axis, expressed by its quaternion; Blender evaluates such expressions without Python.
_Z_AXIS = ("2*(x*z+w*y)", "2*(y*z-w*x)", "1-2*(x*x+y*y)")


@dataclass(frozen=True)
class PrincipledFit:
    """Settings of a Principled BSDF that fits a blended reflectance.

    Attributes
    ----------
    lobe : Ggx
        The best fitting lobe.
    base_color : (3,) float
        Mixed by the weights.
    metallic : float
        Mixed by the weights.
    """

    lobe: Ggx
    base_color: tuple[float, float, float]
    metallic: float


def mixed(colors: Sequence[Sequence[float]], weights: NDArray[np.float64]) -> tuple[float, float, float]:
    """Mix colors, (k, 3), by weights of sum 1."""
    return tuple(float(part) for part in weights @ np.asarray(colors, dtype=np.float64))


def lobe_material(
    name: str,
    tables: Sequence[NDArray[np.float32]],
    diffuse: Sequence[tuple[float, float, float]],
    sun: bpy.types.Object | None,
    frames: Frames | None = None,
    file: str = "",
) -> bpy.types.Material:
    """Create a material that shows tables, or update the last result of that name or file.

    Parameters
    ----------
    name : str
        Name of the material.
    tables : sequence of (64, 256, 3) float32
        f in 1/sr; several tables are the steps of a blend with a slider.
    diffuse : sequence of (3,) float
        Diffuse color of every step.
    sun : bpy.types.Object or None
        A sun whose direction, color and strength the material uses.
    frames : Frames, optional
        Where the slider is animated from 0 to 1.
    file : str
        The file that the tables are from; empty for a blend.
    """
    material, tree = emptied(name, "LOBES", file)
    node = tree.nodes.new("ShaderNodeGroup")
    node.name = node.label = GROUP
    node.node_tree = lobe_group(lobe_image(name, tables))
    node.location = (-220.0, 0.0)
    node.width = 200.0
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(node.outputs["Shader"], output.inputs["Surface"])
    if sun is not None:
        follow(node, sun)
    node.inputs[DIFFUSE].default_value = (*diffuse[len(diffuse) // 2], 1.0)
    if len(tables) > 1 and frames is not None:
        _key(node.inputs[BLEND], frames.of(2), [0.0, 1.0])
        _key(node.inputs[DIFFUSE], frames.of(len(diffuse)), [(*color, 1.0) for color in diffuse])
        make_linear(tree)
    return material


def fitted_material(name: str, fits: Sequence[PrincipledFit], frames: Frames | None = None) -> bpy.types.Material:
    """Create a material with a Principled BSDF, animated if there are several steps and frames; see `lobe_material`."""
    material, tree = emptied(name, "FITTED")
    node = tree.nodes.new("ShaderNodeBsdfPrincipled")
    node.location = (-300.0, 0.0)
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(node.outputs["BSDF"], output.inputs["Surface"])
    steps = {name: [principled_values(fit)[name] for fit in fits] for name in principled_values(fits[0])}
    for name, values in steps.items():
        if len(fits) > 1 and frames is not None:
            _key(node.inputs[name], frames.of(len(fits)), values)
        else:
            node.inputs[name].default_value = values[len(values) // 2]
    if frames is not None:
        make_linear(tree)
        _hold(tree, node.inputs["Anisotropic Rotation"])
    return material


def principled_values(fit: PrincipledFit) -> dict[str, object]:
    """Return the inputs of a Principled BSDF."""
    lobe = fit.lobe
    return {
        "Base Color": (*fit.base_color, 1.0),
        "Metallic": fit.metallic,
        "Roughness": min(lobe.roughness, 1.0),
        "Anisotropic": lobe.anisotropic,
        "Anisotropic Rotation": 0.25 if lobe.alpha_x < lobe.alpha_y else 0.0,
    }


def emptied(name: str, kind: str, file: str = "") -> tuple[bpy.types.Material, bpy.types.NodeTree]:
    """Return the material of an earlier result without its nodes, or a new one. Objects keep the material."""
    own = f"{kind} {file or name}"
    found = (item for item in bpy.data.materials if item.get(RESULT_OF) == own)
    material = last_result(found, name) or bpy.data.materials.new(name)
    material[RESULT_OF] = own
    tree = own_tree(material)
    groups = [node.node_tree for node in tree.nodes if node.type == "GROUP" and node.node_tree is not None]
    images = _images_of(tree)
    clear_animation(tree)
    tree.nodes.clear()
    for group in groups:
        images |= _images_of(group)
        if not group.users:
            bpy.data.node_groups.remove(group)
    _remove_unused(images)
    return material, tree


def _images_of(tree: bpy.types.NodeTree) -> set[bpy.types.Image]:
    return {node.image for node in tree.nodes if node.type == "TEX_IMAGE" and node.image is not None}


def _remove_unused(images: set[bpy.types.Image]) -> None:
    for image in images:
        if not image.users:
            bpy.data.images.remove(image)


def follow(node: bpy.types.Node, sun: bpy.types.Object) -> None:
    """Drive the direction, color and strength of a node by a sun."""
    for axis, expression in enumerate(_Z_AXIS):
        driver = node.inputs[DIRECTION].driver_add("default_value", axis).driver
        for letter in "wxyz":
            variable = driver.variables.new()
            variable.name, variable.type = letter, "TRANSFORMS"
            target = variable.targets[0]
            target.id, target.transform_type, target.rotation_mode = sun, f"ROT_{letter.upper()}", "QUATERNION"
        driver.expression = expression
    _drive(node.inputs[STRENGTH].driver_add("default_value").driver, sun, "data.energy")
    for channel in range(3):
        _drive(node.inputs[LIGHT].driver_add("default_value", channel).driver, sun, f"data.color[{channel}]")


def _drive(driver: bpy.types.Driver, sun: bpy.types.Object, path: str) -> None:
    variable = driver.variables.new()
    variable.type = "SINGLE_PROP"
    variable.targets[0].id, variable.targets[0].data_path = sun, path
    driver.type = "AVERAGE"


def _key(socket: bpy.types.NodeSocket, frames: Sequence[float], values: Sequence[object]) -> None:
    for frame, value in zip(frames, values, strict=True):
        socket.default_value = value
        socket.keyframe_insert("default_value", frame=frame)


def _hold(tree: bpy.types.NodeTree, socket: bpy.types.NodeSocket) -> None:
    """Keep a value until its next key; interpolation would rotate the anisotropy through oblique angles."""
    path = socket.path_from_id("default_value")
    for curve in curves_of(tree):
        if curve.data_path == path:
            for point in curve.keyframe_points:
                point.interpolation = "CONSTANT"
