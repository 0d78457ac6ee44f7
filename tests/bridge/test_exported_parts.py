# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts that are attached to a mesh with shape keys, in files for other programs."""

from __future__ import annotations

import bpy
import numpy as np
import pytest
from scipy.spatial import cKDTree

from convwass_addon.bridge.objects import triangle_mesh
from convwass_addon.bridge.one_mesh.key_files import export_shape_keys, left_out_notices
from convwass_addon.bridge.one_mesh.records import store_records
from tests.attached import attach_parts
from tests.bridge.test_rigged_key_files import rigged  # noqa: F401
from tests.scene import linked

# Blender's own add-ons use what newer versions of NumPy and Python advise against.
pytestmark = [pytest.mark.usefixtures("empty_scene"), pytest.mark.filterwarnings("ignore::DeprecationWarning")]


@pytest.fixture
def dressed(rigged):  # noqa: F811
    """Return a rigged tube with a key, with a sleeve on the same rig and an eye on a moving Empty that follow it."""
    sleeve, eye = (linked(name, bpy.data.meshes.new(name)) for name in ("Sleeve", "Eye"))
    rigged.name = rigged.data.name = "Body"
    points = np.array([vertex.co for vertex in rigged.data.vertices])
    for obj, factors, shift in ((sleeve, (0.5, 1.1, 1.1), (0.0, 0.0, 0.0)), (eye, (0.1, 0.1, 0.1), (0.0, 1.5, 0.0))):
        faces = [tuple(face.vertices) for face in rigged.data.polygons]
        obj.data.from_pydata(points * factors + shift, [], faces)
    sleeve.parent, sleeve.matrix_parent_inverse = rigged.parent, rigged.matrix_parent_inverse
    for name in ("A", "B"):
        sleeve.vertex_groups.new(name=name)
    along = np.array([vertex.co.x for vertex in sleeve.data.vertices])
    sleeve.vertex_groups["A"].add(np.flatnonzero(along < 0.5).tolist(), 1.0, "REPLACE")
    sleeve.vertex_groups["B"].add(np.flatnonzero(along >= 0.5).tolist(), 1.0, "REPLACE")
    sleeve.modifiers.new("Rig", "ARMATURE").object = rigged.modifiers[0].object
    eye.location.z = 3.0
    carrier = linked("Carrier", None)
    eye.parent = carrier
    for frame, height in ((1, 0.0), (5, 2.0)):
        carrier.location.z = height
        carrier.keyframe_insert("location", frame=frame)
    store_records(rigged, [{"name": "Thick", "times": [1.0]}])
    attach_parts(rigged, [sleeve, eye], rigid=False)
    return rigged


def seen(obj, frame):
    bpy.context.scene.frame_set(frame)
    return triangle_mesh(obj, bpy.context.evaluated_depsgraph_get()).vertices


@pytest.mark.parametrize("suffix", [".glb", ".fbx", ".usdc", ".abc"])
def test_parts_are_written_with_their_body(dressed, tmp_path, suffix, inventory):
    names = ("Body", "Sleeve", "Eye")
    expected = {name: [seen(bpy.data.objects[name], frame) for frame in (1, 3, 5)] for name in names}
    assert all(np.abs(np.diff(places, axis=0)).max() > 0.05 for places in expected.values())
    before = inventory()
    (file,) = export_shape_keys(dressed, tmp_path / f"Body{suffix}")
    assert inventory() == before
    assert left_out_notices(dressed, file) == []
    first = {".glb": 0}.get(suffix, 1)
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    if suffix == ".glb":
        bpy.ops.import_scene.gltf(filepath=str(file))
    elif suffix == ".fbx":
        bpy.ops.import_scene.fbx(filepath=str(file))
    elif suffix == ".usdc":
        bpy.ops.wm.usd_import(filepath=str(file))
    else:
        bpy.ops.wm.alembic_import(filepath=str(file))
    meshes = {obj.data.name: obj for obj in bpy.data.objects if obj.type == "MESH"}
    for name, places in expected.items():
        for step, points in enumerate(places):
            found = seen(meshes[name], first + 2 * step)
            np.testing.assert_allclose(cKDTree(found).query(points)[0], 0.0, atol=2e-3, err_msg=name)
    if suffix in (".glb", ".fbx"):
        rigs = [obj for obj in bpy.data.objects if obj.type == "ARMATURE"]
        assert {meshes[name].find_armature() for name in ("Body", "Sleeve")} == set(rigs)
        assert len(rigs) == 1


def test_hidden_parts_are_left_out_and_textures_say_what_they_lack(dressed, tmp_path):
    bpy.data.objects["Eye"].hide_set(True)
    (file,) = export_shape_keys(dressed, tmp_path / "Body.glb")
    (record, *_) = export_shape_keys(dressed, tmp_path / "Body.json")
    assert [str(notice) for notice in left_out_notices(dressed, record)] == [
        "The file lacks the parts of Body (Sleeve); the other formats contain them"
    ]
    bpy.data.objects["Sleeve"].modifiers.new("Wide", "SOLIDIFY")
    assert [str(notice) for notice in left_out_notices(dressed, file)] == [
        "The file lacks the modifiers of Sleeve (Wide); USD and Alembic contain them"
    ]
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.ops.import_scene.gltf(filepath=str(file))
    assert "Sleeve" in bpy.data.objects
    assert "Eye" not in bpy.data.objects
