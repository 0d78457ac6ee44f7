# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel of meshes with shape keys."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from convwass_addon.applications.one_mesh.key_paths import KeyPath
from convwass_addon.bridge.one_mesh.shape_keys import object_with_keys
from convwass_addon.bridge.one_mesh.swapped_objects import with_swap

from .drawing import draw

pytestmark = pytest.mark.usefixtures("empty_scene")


def keyed(name, target):
    bpy.ops.mesh.primitive_cube_add()
    cube = bpy.context.object
    cube.name = name
    places = np.array([vertex.co for vertex in cube.data.vertices], float)
    path = KeyPath(target, (0.5,), 2.0 * places[None], None, 0.0, 0.0, 0.0, 0)
    return object_with_keys(cube, cube.data.copy(), [path], bpy.context.scene)


def sliders_of(obj):
    bpy.context.view_layer.objects.active = obj
    return [name for kind, name in draw(bpy.types.CONVWASS_PT_one_mesh) if kind == "prop"]


def test_both_of_two_meshes_show_the_slider_that_moves_them():
    first, second = keyed("Cup", "Ball"), keyed("Ball", "Cup")
    assert (sliders_of(first), sliders_of(second)) == (['["Ball"]'], ['["Cup"]'])
    with_swap(first, second, ("Ball", "Cup"), "Ball", 0.5)
    assert (sliders_of(first), sliders_of(second)) == (['["Ball"]'], ['["Ball"]'])
    bpy.data.objects.remove(first)
    assert sliders_of(second) == ['["Cup"]']
