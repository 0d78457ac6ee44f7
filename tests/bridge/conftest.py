# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes and checks that the bridge's tests share."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.meshes.mesh import TriangleMesh


@pytest.fixture(scope="session")
def factory_preferences():
    """Reset the preferences once: it would register Blender's own add-ons again, for every test."""
    import bpy

    bpy.ops.wm.read_factory_settings(use_empty=True)


@pytest.fixture(autouse=True)
def bare_scene(factory_preferences):
    """Blender with factory settings and nothing in the scene; returns that scene."""
    import bpy

    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    return bpy.context.scene


@pytest.fixture
def depsgraph():
    """Give the context's depsgraph, which is another one in each file."""
    import bpy

    return bpy.context.evaluated_depsgraph_get()


@pytest.fixture
def make_object():
    """Give a function that adds a unit octahedron to the scene, or a mesh of other geometry."""
    return _make_object


@pytest.fixture
def octahedron() -> TriangleMesh:
    """Give a closed outward octahedron with corners at distance 1 from the origin; volume 4/3."""
    return _octahedron()


@pytest.fixture
def moving(make_object):
    """Bake a ball that moves; see `moving_balls`."""
    from tests.moving_balls import moving_ball

    return moving_ball(make_object)


@pytest.fixture
def player(bare_scene, scene_with):
    """Give a player that interpolates between the places of a ball that moves, in a scene of its own."""
    return scene_with(_make_player).objects["Player"]


@pytest.fixture
def inventory():
    """Give a function that names all data-blocks in the file."""
    import bpy

    return lambda: {(block.id_type, block.name) for block in bpy.data.user_map()}


def _octahedron() -> TriangleMesh:
    vertices = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], dtype=float)
    x, y = (0, 1), (2, 3)
    faces = [(x[i], y[j], 4) if i == j else (y[j], x[i], 4) for i in (0, 1) for j in (0, 1)]
    faces += [(b, a, 5) for a, b, _ in faces]
    return TriangleMesh.from_arrays(vertices, faces)


def _make_player():

    from convwass_addon.bridge.morphs.players.player import make_player
    from tests.moving_balls import moving_ball

    make_player(moving_ball(_make_object), between="INTERPOLATED").name = "Player"


def _make_object(name, vertices=None, edges=(), faces=None):
    import bpy

    mesh = bpy.data.meshes.new(name)
    if vertices is None:
        vertices, faces = _octahedron().vertices, _octahedron().faces
    mesh.from_pydata(np.asarray(vertices).tolist(), list(edges), [] if faces is None else np.asarray(faces).tolist())
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    return obj
