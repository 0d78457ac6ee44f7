# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials, worlds and skies for the tests of materials and skies."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import bpy
import numpy as np
import pytest

from convwass_addon.applications.reflectance import lobe_interpolation, lobe_lookup
from convwass_addon.applications.reflectance.lobe_table import incoming_directions
from convwass_addon.bridge.nodes.node_trees import own_tree
from convwass_addon.transport.sphere import directions, solid_angles


@contextmanager
def coarse_lobes() -> Iterator[None]:
    """Tabulate few lobes of materials, and average texels over two directions: most of the time goes there."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(lobe_interpolation, "incoming_directions", lambda _, turns: incoming_directions(2, min(turns, 4)))
        patch.setattr(lobe_lookup, "_AZIMUTHS", 2)
        yield


def principled(name, roughness, **values):
    """Make a metal; `values` are inputs of the Principled BSDF with underscores for spaces."""
    material = bpy.data.materials.new(name)
    node = next(node for node in own_tree(material).nodes if node.type == "BSDF_PRINCIPLED")
    node.inputs["Roughness"].default_value = roughness
    node.inputs["Metallic"].default_value = 1.0
    for key, value in values.items():
        node.inputs[key.replace("_", " ").title()].default_value = value
    return material


def glossy(name, roughness):
    """Make a white Glossy BSDF."""
    material = bpy.data.materials.new(name)
    tree = own_tree(material)
    tree.nodes.clear()
    node = tree.nodes.new("ShaderNodeBsdfAnisotropic")
    node.distribution = "GGX"
    node.inputs["Roughness"].default_value = roughness
    node.inputs["Color"].default_value = (1, 1, 1, 1)
    tree.links.new(node.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs[0])
    return material


def only(material, kind):
    """Return the node of a kind in a material."""
    (node,) = (node for node in material.node_tree.nodes if node.type == kind)
    return node


def sky(sun, rows=64, color=(1.0, 0.8, 0.5)):
    """Return a uniform blue sky with a glow and a sun of one pixel, (rows, 2 rows, 3)."""
    vectors = directions(rows, 2 * rows)
    sun = np.asarray(sun) / np.linalg.norm(sun)
    image = np.full((rows, 2 * rows, 3), (0.2, 0.3, 0.5)) + 2.0 * np.exp(8 * (vectors @ sun - 1))[..., None]
    place = np.unravel_index(np.argmax(vectors @ sun), vectors.shape[:2])
    image[place] += 2.0 / solid_angles(rows, 2 * rows)[place[0], 0] * np.array(color)
    return image.astype(np.float32)
