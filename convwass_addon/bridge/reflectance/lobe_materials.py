# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Create materials that show blended lobes: as tables, or by the best fitting Principled BSDF."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.reflectance.materials import Ggx
from ..edited_materials import is_edited, remember_made
from ..keyframes import clear_animation, curves_of, drivers_of, interpolate, own_action, remove_curve
from ..last_result import last_result
from ..nodes.node_trees import own_tree
from ..unused_data import remove_if_unused
from .frame_span import Frames
from .lobe_images import lobe_image
from .lobe_nodes import BLEND, DIFFUSE, GROUP, lobe_group
from .sun_drivers import follow, followed_light, leave_light

RESULT_OF = "convwass_lobes"
"""Custom property of a result: the source materials and the way of showing the blend."""

_KEEPS_NODES = "convwass_keeps_nodes"
"""Custom property of a result whose nodes are kept, even if the own ones are gone, unlike those of earlier versions."""


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
    material, tree = result_material(name, "LOBES", file)
    node, _ = lobe_node(tree, name, tables, lobe_group)
    follow(node, sun)
    if len(tables) > 1 and frames is not None:
        animate(node.inputs[BLEND], [0.0, 1.0], frames.of(2))
    animate(node.inputs[DIFFUSE], [(*color, 1.0) for color in diffuse], frames and frames.of(len(diffuse)))
    return material


def fitted_material(name: str, fits: Sequence[PrincipledFit], frames: Frames | None = None) -> bpy.types.Material:
    """Create a material with a Principled BSDF, animated if there are several steps and frames; see `lobe_material`."""
    material, tree = result_material(name, "FITTED")
    node, _ = principled_node(tree)
    for own in principled_values(fits[0]):
        values = [principled_values(fit)[own] for fit in fits]
        # Interpolation would rotate the anisotropy through oblique angles.
        how = "CONSTANT" if own == "Anisotropic Rotation" else "LINEAR"
        animate(node.inputs[own], values, frames and frames.of(len(fits)), how)
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


def result_material(
    name: str,
    kind: str,
    file: str = "",
    *,
    choose: Callable[[list[bpy.types.Material]], list[bpy.types.Material]] = list,
) -> tuple[bpy.types.Material, bpy.types.NodeTree]:
    """Return the material of an earlier result with its nodes, or a new one without nodes. Objects keep the material.

    Nodes of a result are marked, so that all others, which the user has added, are kept. The nodes of results of
    earlier versions, which have no marks, are removed.

    Parameters
    ----------
    name, kind, file : str
        What the result shows, and how.
    choose : callable
        Returns which of some earlier results may be changed.
    """
    own = f"{kind} {file or name}"
    results = [item for item in bpy.data.materials if item.get(RESULT_OF) == own]
    material = last_result(choose(results), name) or bpy.data.materials.new(name)
    material[RESULT_OF] = own
    tree = own_tree(material)
    are_kept = _KEEPS_NODES in material or any(RESULT_OF in node for node in tree.nodes)
    material[_KEEPS_NODES] = True
    if are_kept:
        own_action(tree)
        return material, tree
    groups = [node.node_tree for node in tree.nodes if node.type == "GROUP" and node.node_tree is not None]
    images = _images_of(tree)
    clear_animation(tree)
    tree.nodes.clear()
    images = images.union(*map(_images_of, groups))
    remove_if_unused(groups)
    remove_if_unused(images)
    return material, tree


def result_node(tree: bpy.types.NodeTree, name: str, kind: str) -> tuple[bpy.types.Node, bool]:
    """Return a node of a result by its name, and whether it is new."""
    found = next((node for node in tree.nodes if node.get(RESULT_OF) == name), None)
    if found is not None:
        return found, False
    node = tree.nodes.new(kind)
    node.name, node[RESULT_OF] = name, name
    return node, True


def lobe_node(
    tree: bpy.types.NodeTree,
    name: str,
    tables: Sequence[NDArray[np.float32]],
    make: Callable[[bpy.types.Image], bpy.types.NodeTree],
) -> tuple[bpy.types.Node, bool]:
    """Return the node that shows tables, and whether it is new; values and links of an earlier one are kept.

    Parameters
    ----------
    tree : bpy.types.NodeTree
        From `result_material`.
    name, tables
        As for :func:`.lobe_images.lobe_image`.
    make : callable
        Creates the node group from the image: :func:`.lobe_nodes.lobe_group` or the like.
    """
    image = lobe_image(name, tables)
    image[RESULT_OF] = True
    node, is_new = result_node(tree, GROUP, "ShaderNodeGroup")
    if is_new:
        node.label, node.location, node.width = GROUP, (-220.0, 0.0), 200.0
    edited = node.node_tree is not None and is_edited(node.node_tree)
    if not _took_image(node.node_tree, image):
        _show_group(node, make(image), keep=edited)
        edited = False
    # These names were taken before.
    image.name, node.node_tree.name = name, GROUP
    if not edited:
        remember_made(node.node_tree)
    if is_new:
        show(node.outputs["Shader"])
        leave_light(node)
    return node, is_new


def principled_node(tree: bpy.types.NodeTree) -> tuple[bpy.types.Node, bool]:
    """Return the Principled BSDF of a result, and whether it is new; values and links of an earlier one are kept."""
    node, is_new = result_node(tree, "Principled BSDF", "ShaderNodeBsdfPrincipled")
    if is_new:
        node.location = (-300.0, 0.0)
        show(node.outputs["BSDF"])
    return node, is_new


def show(shader: bpy.types.NodeSocket) -> None:
    """Link a shader to the output of its material, unless that shows another one."""
    tree = shader.id_data
    output = tree.get_output_node("ALL") or tree.nodes.new("ShaderNodeOutputMaterial")
    if not output.inputs["Surface"].is_linked:
        tree.links.new(shader, output.inputs["Surface"])


def _took_image(group: bpy.types.NodeTree | None, image: bpy.types.Image) -> bool:
    """Show another image of the same size in a group that nothing else uses; return whether that is possible."""
    nodes = [] if group is None else [node for node in group.nodes if node.type == "TEX_IMAGE" and is_own(node.image)]
    images = {node.image for node in nodes}
    if not images or group.users > 1 or any(own.size[:] != image.size[:] for own in images):
        return False
    for node in nodes:
        node.image = image
    remove_if_unused(images)
    return True


def is_own(image: bpy.types.Image | None) -> bool:
    """Return whether an image was made for a result."""
    return image is not None and RESULT_OF in image


def _show_group(node: bpy.types.Node, group: bpy.types.NodeTree, *, keep: bool) -> None:
    """Show another group with a node; inputs of the same names keep their values and links.

    The group before is removed if nothing else uses it and it is not to be kept.
    """
    before, tree = node.node_tree, node.id_data
    names, followed = node.inputs.keys(), followed_light(node)
    values = {own.name: _value(own) for own in node.inputs if hasattr(own, "default_value")}
    fed = [(link.from_socket, own.name) for own in node.inputs for link in own.links]
    feeding = [(own.name, link.to_socket) for own in node.outputs for link in own.links]
    node.node_tree = group
    for own in node.inputs:
        own.default_value = values.get(own.name, own.default_value)
    for source, name in fed:
        if name in node.inputs:
            tree.links.new(source, node.inputs[name])
    for name, target in feeding:
        if name in node.outputs:
            tree.links.new(node.outputs[name], target)
    if names and names != node.inputs.keys():
        _drop_animation(node)
        leave_light(node, followed)
    if keep:
        before.use_fake_user = True
    elif before is not None and not before.users:
        images = set(filter(is_own, _images_of(before)))
        bpy.data.node_groups.remove(before)
        remove_if_unused(images)


def _value(socket: bpy.types.NodeSocket) -> object:
    """Return a copy of the value of a socket, which stays when the socket is gone."""
    value = socket.default_value
    return value[:] if hasattr(value, "__len__") and not isinstance(value, str) else value


def _drop_animation(node: bpy.types.Node) -> None:
    """Remove the animation of the inputs of a node, whose numbers have changed."""
    tree, start = node.id_data, f"{node.path_from_id()}.inputs["
    for path in {curve.data_path for curve in curves_of(tree) if curve.data_path.startswith(start)}:
        remove_curve(tree, path)
    for curve in drivers_of(tree):
        if curve.data_path.startswith(start):
            tree.animation_data.drivers.remove(curve)


def _images_of(tree: bpy.types.NodeTree) -> set[bpy.types.Image]:
    return {node.image for node in tree.nodes if node.type == "TEX_IMAGE" and node.image is not None}


def animate(
    socket: bpy.types.NodeSocket, values: Sequence[object], frames: Sequence[float] | None = None, how: str = "LINEAR"
) -> None:
    """Key the values of a socket, instead of earlier ones; without frames, set it to the one in the middle."""
    tree, path = socket.id_data, socket.path_from_id("default_value")
    remove_curve(tree, path)
    if frames is None or len(values) < 2:
        socket.default_value = values[len(values) // 2]
        return
    for frame, value in zip(frames, values, strict=True):
        socket.default_value = value
        socket.keyframe_insert("default_value", frame=frame)
    interpolate(curves_of(tree, path), how)
