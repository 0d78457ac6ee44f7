# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""New meshes that get shape keys instead of the first shape's own."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from convwass_addon.bridge.one_mesh.remeshed_rest import remeshed_shape
from convwass_addon.errors import InputError
from convwass_addon.geometry.edges import topology

pytestmark = pytest.mark.usefixtures("empty_scene")

CELLS = 32


@pytest.fixture
def capsule():
    """A ball of radius 1 at z = 3, whose lower half has another material."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, location=(0.0, 0.0, 3.0))
    obj = bpy.context.object
    for name in ("Top", "Bottom"):
        obj.data.materials.append(bpy.data.materials.new(name))
    for polygon in obj.data.polygons:
        polygon.material_index = int(polygon.center.z < 0.0)
    return obj


@pytest.mark.parametrize("kind", ["EVEN", "ADAPTIVE", "QUADS"])
def test_a_new_mesh_lies_on_the_shape_and_has_its_materials(capsule, kind, inventory):
    before = inventory()
    found = remeshed_shape(capsule, bpy.context.evaluated_depsgraph_get(), kind, CELLS)
    mesh = found.rest.mesh
    assert topology(found.shape).closed
    np.testing.assert_allclose(np.linalg.norm(found.shape.vertices - [0, 0, 3], axis=1), 1.0, atol=0.01)
    assert found.shape.volume == pytest.approx(4.0 / 3.0 * np.pi, rel=0.02)
    written = np.array([vertex.co for vertex in mesh.vertices])
    np.testing.assert_allclose(written, found.shape.vertices, atol=1e-4)
    for polygon in mesh.polygons:
        if abs(polygon.center.z - 3.0) > 0.1:
            assert mesh.materials[polygon.material_index].name == ("Bottom" if polygon.center.z < 3.0 else "Top")
    sides = {len(polygon.vertices) for polygon in mesh.polygons}
    assert max(sides) == (4 if kind == "QUADS" else 3)
    bpy.data.meshes.remove(mesh)
    assert inventory() == before


def test_a_plane_cannot_be_remeshed(inventory):
    bpy.ops.mesh.primitive_plane_add()
    before = inventory()
    with pytest.raises(InputError, match="encloses no volume"):
        remeshed_shape(bpy.context.object, bpy.context.evaluated_depsgraph_get(), "EVEN", CELLS)
    assert inventory() == before
