# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Read the highlights of Blender's materials in closed form."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np

from ...applications.reflectance.materials import Ggx
from ...errors import InputError
from ...sentence import Sentence
from ..files.image_files import pixel_values
from ..nodes.shown_nodes import linked_output, shown_tree, source_node

_QUARTER_TOLERANCE = 1e-3
# Glossy BSDF allows an aspect of 0, which no table can represent.
_MOST_GLOSSY_ANISOTROPY = 0.99


@dataclass(frozen=True)
class GlossyMaterial:
    """The interpolated properties of a material.

    Attributes
    ----------
    name : str
        Name of the material.
    lobe : Ggx
        Highlight, in its color seen from above.
    base_color : (3,) float
        As in Principled BSDF.
    metallic : float
        As in Principled BSDF.
    notices : tuple of Sentence
        Properties that were ignored.
    """

    name: str
    lobe: Ggx
    base_color: tuple[float, float, float]
    metallic: float
    notices: tuple[Sentence, ...] = ()

    @property
    def diffuse(self) -> tuple[float, float, float]:
        """Color of the diffuse part; black for metals."""
        return tuple((1.0 - self.metallic) * part for part in self.base_color)


def read_glossy(material: bpy.types.Material) -> GlossyMaterial:
    """Read the highlight of a material with a Principled or Glossy BSDF.

    Raises
    ------
    InputError
        Another shader, an input from a texture, or an anisotropic rotation that is not a multiple of 90 degrees.
    """
    node = _shader(material)
    if node.type == "BSDF_GLOSSY":
        return _read_glossy(material, node)
    means: list[Sentence] = []
    values = {name: _value(material, node, name, means) for name in ("Roughness", "Anisotropic", "Metallic")}
    base, notices = _color(material, node, "Base Color")
    level = _value(material, node, "Specular IOR Level", means)
    ior = _value(material, node, "IOR", means)
    dielectric = min(2.0 * level * ((ior - 1.0) / (ior + 1.0)) ** 2, 1.0)
    tint, more = _color(material, node, "Specular Tint")
    metallic = values["Metallic"]
    color = tuple(
        float(min(metallic * own + (1.0 - metallic) * dielectric * part, 1.0))
        for own, part in zip(base, tint, strict=True)
    )
    lobe = Ggx.principled(values["Roughness"], values["Anisotropic"], color)
    if _is_turned(material, node, "Anisotropic Rotation", lobe):
        lobe = Ggx(lobe.alpha_y, lobe.alpha_x, color)
    return GlossyMaterial(material.name, lobe, base, metallic, (*means, *notices, *more))


def _read_glossy(material: bpy.types.Material, node: bpy.types.Node) -> GlossyMaterial:
    color, notices = _color(material, node, "Color")
    means: list[Sentence] = []
    # The sign selects the axis; Cycles multiplies one axis and divides the other.
    given = _value(material, node, "Anisotropy", means)
    anisotropy = float(np.clip(given, -_MOST_GLOSSY_ANISOTROPY, _MOST_GLOSSY_ANISOTROPY))
    alpha, aspect = max(_value(material, node, "Roughness", means) ** 2, 1e-3), 1.0 - abs(anisotropy)
    small, large = alpha * aspect, min(alpha / aspect, 1.0)
    lobe = Ggx(max(small, 1e-3), large, color) if anisotropy > 0 else Ggx(large, max(small, 1e-3), color)
    if _is_turned(material, node, "Rotation", lobe):
        lobe = Ggx(lobe.alpha_y, lobe.alpha_x, color)
    return GlossyMaterial(material.name, lobe, color, 1.0, (*means, *notices))


def _shader(material: bpy.types.Material) -> bpy.types.Node:
    """Return the BSDF of the active output; raises InputError if it shows something else."""
    tree = shown_tree(material)
    output = tree.get_output_node("CYCLES") if tree is not None else None
    node = source_node(output.inputs["Surface"]) if output is not None else None
    if node is None or node.type not in ("BSDF_PRINCIPLED", "BSDF_GLOSSY"):
        raise InputError(
            "{material} does not end in a Principled or Glossy BSDF, so its highlight is unknown.",
            material=material.name,
        )
    return node


def _value(material: bpy.types.Material, node: bpy.types.Node, name: str, means: list[Sentence]) -> float:
    """Return the value of an input; for an image linked directly to it, the mean, with a notice."""
    socket = node.inputs[name]
    if not socket.is_linked:
        return float(socket.default_value)
    mean = _mean_of(socket)
    if mean is None:
        raise InputError(
            "{name} of {material} comes from another node; unlink it and give it one value.",
            name=name,
            material=material.name,
        )
    values = {"name": name, "material": material.name, "mean": mean}
    means.append(Sentence("{name} of {material} is an image; its mean, {mean:.2f}, counts everywhere.", values))
    return mean


def _mean_of(socket: bpy.types.NodeSocket) -> float | None:
    """Return the mean of an image that is linked directly to an input as plain numbers; None for anything else."""
    node, output = source_node(socket), linked_output(socket)
    is_image = node is not None and node.type == "TEX_IMAGE" and output.name == "Color"
    image = node.image if is_image else None
    # Accessing a pixel loads the file.
    if image is None or not image.colorspace_settings.is_data or not len(image.pixels) or image.channels < 3:
        return None
    mean = float(pixel_values(image).reshape(-1, image.channels)[:, :3].mean())
    return min(max(mean, 0.0), 1.0) if np.isfinite(mean) else None


def _color(
    material: bpy.types.Material, node: bpy.types.Node, name: str
) -> tuple[tuple[float, float, float], tuple[Sentence, ...]]:
    socket = node.inputs[name]
    color = tuple(float(min(max(part, 0.0), 1.0)) for part in tuple(socket.default_value)[:3])
    if not socket.is_linked:
        return color, ()
    values = {"name": name, "material": material.name}
    return color, (Sentence("{name} of {material} comes from another node; its unlinked color is used.", values),)


def _is_turned(material: bpy.types.Material, node: bpy.types.Node, name: str, lobe: Ggx) -> bool:
    """Return whether the highlight is stretched across the tangent instead of along it."""
    if lobe.is_isotropic:
        return False
    socket = node.inputs[name]
    quarters = 4.0 * float(socket.default_value)
    if socket.is_linked or abs(quarters - round(quarters)) > _QUARTER_TOLERANCE:
        raise InputError(
            "The anisotropic rotation of {material} is oblique; set it to 0 or a quarter turn.", material=material.name
        )
    return round(quarters) % 2 == 1
