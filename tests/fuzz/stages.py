# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes with all kinds of objects, valid and broken, in every mode of Blender."""

from __future__ import annotations

import math
from contextlib import suppress
from pathlib import Path
from random import Random

import bpy
import numpy as np

from convwass_addon.bridge.vertex_groups import write_group
from tests.lights import principled
from tests.operators.soft_maps import store_closest
from tests.pictures import image_of
from tests.rigs import chain, lines

MODES = (
    *("OBJECT", "OBJECT", "OBJECT", "EDIT", "EDIT", "SCULPT", "VERTEX_PAINT", "WEIGHT_PAINT", "TEXTURE_PAINT", "POSE"),
    *("PARTICLE_EDIT", "SCULPT_CURVES", "EDIT_GPENCIL", "SCULPT_GREASE_PENCIL", "PAINT_GREASE_PENCIL"),
    *("WEIGHT_GREASE_PENCIL", "VERTEX_GREASE_PENCIL"),
)
AREAS = ("VIEW_3D", "VIEW_3D", "IMAGE_EDITOR", "NODE_EDITOR", "OUTLINER", "CONSOLE", "TEXT_EDITOR", None)


def build(random: Random, library: Path) -> None:
    """Make a scene with some of everything and an arbitrary selection."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if random.random() < 0.05:
        return
    for make in random.sample(MAKERS, random.randint(1, 7)):
        with suppress(RuntimeError):
            leave_mode()
            if make is linked:
                linked(random, library)
            else:
                make(random)
    leave_mode()
    for obj in bpy.data.objects:
        if random.random() < 0.06:
            obj.hide_viewport = True
        if random.random() < 0.04:
            obj.scale = random.choice(((0, 0, 0), (1, 1, 0), (-1, 1, 1), (1e-20,) * 3, (1e18,) * 3, (math.nan, 1, 1)))
        if random.random() < 0.05:
            obj.location = random.choice(((1e30, 0, 0), (math.inf, 0, 0), (1e6, 1e6, 1e6)))
        if obj.type == "MESH" and random.random() < 0.15:
            with suppress(RuntimeError, TypeError):
                obj.modifiers.new(
                    "M", random.choice(("SUBSURF", "MASK", "DECIMATE", "SOLIDIFY", "SKIN", "NODES", "BUILD"))
                )


def leave_mode() -> None:
    """Go to Object Mode."""
    active = bpy.context.view_layer.objects.active
    if active is not None and active.mode != "OBJECT":
        with suppress(RuntimeError):
            bpy.ops.object.mode_set(mode="OBJECT")


def enter_some_mode(random: Random) -> None:
    """Make a random selection and an active object, and enter one of its modes."""
    leave_mode()
    objects = list(bpy.context.view_layer.objects)
    for obj in objects:
        with suppress(RuntimeError):
            obj.select_set(random.random() < 0.6)
    bpy.context.view_layer.objects.active = random.choice([*objects, None]) if objects else None
    if bpy.context.view_layer.objects.active is not None:
        with suppress(RuntimeError, TypeError):
            bpy.ops.object.mode_set(mode=random.choice(MODES))


def add(name: str, data: object) -> bpy.types.Object:
    """Link a new object with some data."""
    obj = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def mesh(name: str, vertices: object, edges: object = (), faces: object = ()) -> bpy.types.Object:
    """Link a new mesh."""
    data = bpy.data.meshes.new(name)
    data.from_pydata(np.asarray(vertices, float).reshape(-1, 3).tolist(), list(edges), list(faces))
    return add(name, data)


def balls(random: Random) -> None:
    """Two spheres with groups, and a map between them."""
    made = []
    for place in range(2):
        bpy.ops.mesh.primitive_uv_sphere_add(
            segments=12, ring_count=6, location=(random.choice((0, 3, 1)) * place, 0, 0)
        )
        obj = bpy.context.object
        points = np.array([vertex.co for vertex in obj.data.vertices])
        write_group(obj, "A", (points[:, 0] > 0.7).astype(float))
        write_group(obj, "B", (points[:, 0] < -0.7).astype(float))
        obj.vertex_groups.new(name="Empty")
        obj.vertex_groups.active_index = random.randint(0, 2)
        obj.shape_key_add(name="Basis")
        obj.shape_key_add(name="Key")
        made.append(obj)
    if random.random() < 0.5:
        store_closest(*made)


def solids(random: Random) -> None:
    """A cube with a material, a monkey or a cone."""
    bpy.ops.mesh.primitive_cube_add(location=(4, 0, 0))
    bpy.context.object.data.materials.append(principled("Metal", 0.4))
    bpy.context.object.data.materials.append(None)
    bpy.ops.mesh.primitive_cone_add(vertices=8, location=(0, 4, 0))
    bpy.context.object.data.color_attributes.new("Col", "BYTE_COLOR", "CORNER")


def broken(random: Random) -> None:
    """Meshes that are no valid shapes."""
    nan, tiny = float("nan"), 1e-30
    triangle = [(0, 1, 2)]
    cases = (
        ("Nothing", [], [], []),
        ("Point", [(0, 0, 0)], [], []),
        ("Edge", [(0, 0, 0), (1, 0, 0)], [(0, 1)], []),
        ("NaN", [(nan, 0, 0), (1, 0, 0), (0, 1, 0)], [], triangle),
        (
            "Huge",
            [(1e30, 0, 0), (0, 1e30, 0), (0, 0, 1e30), (0, 0, 0)],
            [],
            [(0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)],
        ),
        (
            "Tiny",
            [(tiny, 0, 0), (0, tiny, 0), (0, 0, tiny), (0, 0, 0)],
            [],
            [(0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)],
        ),
        ("Needle", [(0, 0, 0), (1, 0, 0), (2, 0, 0)], [], triangle),
        ("Double", [(0, 0, 0)] * 4, [], [(0, 1, 2), (0, 2, 3)]),
        ("Sheet", [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [], [(0, 1, 2, 3)]),
        ("Ngon", [(math.cos(a) * (1 + a % 2), math.sin(a), 0) for a in range(6)], [], [tuple(range(6))]),
        ("Loose", [(0, 0, 0), (1, 0, 0), (0, 1, 0), (5, 5, 5)], [], triangle),
    )
    for name, vertices, edges, faces in random.sample(cases, random.randint(1, 4)):
        obj = mesh(name, vertices, edges, faces)
        if len(vertices):
            group = obj.vertex_groups.new(name="A")
            group.add(list(range(len(vertices))), random.choice((1.0, 0.0)), "REPLACE")
            obj.vertex_groups.new(name="B").add([0], 1.0, "REPLACE")


def rigs(random: Random) -> None:
    """An armature with pins, one without bones, and a graph of edges."""
    if random.random() < 0.7:
        chain(random.randint(1, 4))
    if random.random() < 0.4:
        add("Boneless", bpy.data.armatures.new("Boneless"))
    if random.random() < 0.5:
        points = random.choice(
            ([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [(0, 0, 0)] * 3, [(float("nan"), 0, 0), (1, 0, 0), (0, 0, 1)])
        )
        lines(points, [(0, 1), (1, 2)])


def flat(random: Random) -> None:
    """Curves and texts, including empty ones."""
    if random.random() < 0.6:
        bpy.ops.curve.primitive_bezier_circle_add(location=(random.random(), 0, 0))
        bpy.context.object.data.dimensions = random.choice(("2D", "3D"))
    if random.random() < 0.6:
        text = bpy.data.curves.new("Text", "FONT")
        text.body = random.choice(("", " ", "Ab", "日本", "O\nO"))
        add("Text", text)
    if random.random() < 0.5:
        curve = bpy.data.curves.new("Open", "CURVE")
        if random.random() < 0.7:
            spline = curve.splines.new(random.choice(("POLY", "BEZIER", "NURBS")))
            if spline.type == "BEZIER":
                spline.bezier_points.add(random.randint(0, 3))
            else:
                spline.points.add(random.randint(0, 4))
                for place, point in enumerate(spline.points):
                    point.co = (place % 2, place // 2, random.choice((0, 0, float("nan"))), 1)
        add("Open", curve)


def others(random: Random) -> None:
    """Objects of types that are not shapes."""
    makers = {
        "Lattice": lambda: bpy.data.lattices.new("Lattice"),
        "Meta": lambda: bpy.data.metaballs.new("Meta"),
        "Camera": lambda: bpy.data.cameras.new("Camera"),
        "Sun": lambda: bpy.data.lights.new("Sun", "SUN"),
        "Volume": lambda: bpy.data.volumes.new("Volume"),
        "Hair": lambda: bpy.data.hair_curves.new("Hair"),
        "Cloud": lambda: bpy.data.pointclouds.new("Cloud"),
        "Pencil": lambda: getattr(bpy.data, "grease_pencils_v3", bpy.data.grease_pencils).new("Pencil"),
        "Empty": lambda: None,
        "Speaker": lambda: bpy.data.speakers.new("Speaker"),
    }
    for name in random.sample(sorted(makers), random.randint(1, 5)):
        with suppress(AttributeError):
            add(name, makers[name]())


def pictures(random: Random) -> None:
    """Images of all kinds, with and without objects, and worlds."""
    own = bpy.context.scene.convwass_recolor
    cases = {
        "Good": np.random.default_rng(1).random((8, 9, 4)),
        "One": np.ones((1, 1, 4)),
        "NaN": np.full((4, 4, 4), np.nan),
        "Inf": np.full((4, 4, 4), np.inf),
        "Black": np.zeros((5, 3, 4)),
        "Clear": np.random.default_rng(1).random((6, 6, 4)) * (1, 1, 1, 0),
        "Bright": np.full((4, 4, 4), 1e30),
    }
    for name in random.sample(sorted(cases), random.randint(1, 5)):
        made = image_of(name, cases[name], as_floats=random.random() < 0.6)
        if random.random() < 0.5:
            own.palette = made
    if random.random() < 0.4:
        gone = bpy.data.images.new("Gone", 4, 4)
        gone.source, gone.filepath = "FILE", "/no/such/file.png"
        obj = add("Picture", None)
        obj.empty_display_type, obj.data = "IMAGE", random.choice([gone, *bpy.data.images])
    for name in ("W1", "W2")[: random.randint(0, 2)]:
        bpy.data.worlds.new(name)
    principled("A", random.random())
    principled("B", random.random())


def ready(random: Random) -> None:
    """Everything chosen and baked, so that operators have input."""
    scene, call = bpy.context.scene, bpy.ops.convwass
    for make in random.sample((baked_morph, solved_density, stored_map, pinned_rig, palettes, materials_and_skies), 2):
        leave_mode()
        make(random, scene, call)


def baked_morph(random: Random, scene: bpy.types.Scene, call: object) -> None:
    for place in (0, 3):
        bpy.ops.mesh.primitive_cube_add(location=(place, 0, 0))
        bpy.context.object.name = f"In {place}"
    call.bake_morph(
        motion="TRANSPORT", frames=2, resolution=16, inputs="In 0, In 3", use_custom_blur=True, blur=0.6, carry=False
    )
    if random.random() < 0.5:
        call.make_player()
    if random.random() < 0.5:
        for obj in bpy.data.objects:
            obj.select_set(obj.name.startswith("In"))
        call.add_morph_inputs()


def solved_density(random: Random, scene: bpy.types.Scene, call: object) -> None:
    balls(random)
    call.interpolate_density(first="A", second="B", steps=2, max_iterations=20)
    bpy.context.object.convwass_density.first = "A"
    call.add_density_stop(group="A")
    call.add_density_stop(group="B")


def stored_map(random: Random, scene: bpy.types.Scene, call: object) -> None:
    made = []
    for place in (0, 2):
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, location=(place, 0, 0))
        made.append(bpy.context.object)
        write_group(made[-1], "A", np.arange(len(made[-1].data.vertices)) % 2.0)
    store_closest(*made)
    call.add_map_pair(source_vertex=0, target_vertex=0)


def pinned_rig(random: Random, scene: bpy.types.Scene, call: object) -> None:
    bpy.ops.mesh.primitive_uv_sphere_add(segments=12, ring_count=6, radius=3)
    body, rig = bpy.context.object, chain(3, 0.7)
    scene.convwass_armature.body, scene.convwass_armature.rig = body, rig
    call.pin_joints(joints="A.head, C.tail")


def palettes(random: Random, scene: bpy.types.Scene, call: object) -> None:
    for number, name in enumerate(("Red", "Blue")):
        made = image_of(name, np.random.default_rng(number).random((8, 9, 4)))
    scene.convwass_recolor.palette = made
    for _ in range(2):
        bpy.ops.mesh.primitive_cube_add()
        bpy.context.object.data.color_attributes.new("Col", "FLOAT_COLOR", "POINT")
        scene.convwass_recolor.palette_object = bpy.context.object


def materials_and_skies(random: Random, scene: bpy.types.Scene, call: object) -> None:
    own = scene.convwass_reflectance
    own.material, own.material_2 = principled("M1", 0.4), principled("M2", 0.7)
    own_sky = scene.convwass_sky
    own_sky.first, own_sky.last = (bpy.data.worlds.new(name) for name in ("W1", "W2"))


def painted_cubes() -> None:
    """Two cubes named In 0 and In 1, with the groups A and B."""
    for place in range(2):
        bpy.ops.mesh.primitive_cube_add(location=(3 * place, 0, 0))
        obj = bpy.context.object
        obj.name = f"In {place}"
        for name, side in (("A", 1), ("B", -1)):
            write_group(obj, name, np.array([float(vertex.co.x * side > 0) for vertex in obj.data.vertices]))


def crowd(random: Random) -> None:
    """Very many components, and very many objects."""
    bpy.ops.mesh.primitive_cube_add(size=0.5)
    array = bpy.context.object.modifiers.new("Array", "ARRAY")
    array.count = random.choice((1, 50, 400))
    for number in range(random.choice((0, 30))):
        add(f"Many {number}", bpy.context.object.data)


def odd_names(random: Random) -> None:
    """Names that are awkward to quote or look up."""
    for name in random.sample(("a,b", "a\nb", " ", "{x}", "ä" * 60, "../x", "Morph", "%s", "0"), 3):
        bpy.ops.mesh.primitive_cube_add()
        bpy.context.object.name = name
        bpy.context.object.vertex_groups.new(name=name)


def linked(random: Random, library: Path) -> None:
    """Objects of another file, some of them overridden."""
    with bpy.data.libraries.load(str(library), link=True) as (there, here):
        here.objects, here.images, here.materials = there.objects, there.images, there.materials
        here.collections = there.collections
    for obj in here.objects:
        if obj is not None:
            bpy.context.scene.collection.objects.link(obj)
            if random.random() < 0.4:
                obj.override_create(remap_local_usages=True)


def write_library(path: Path) -> None:
    """Write the file for :func:`linked`."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    random = Random(1)
    balls(random)
    rigs(random)
    solids(random)
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)


MAKERS = (ready, ready, ready, ready, balls, solids, broken, rigs, flat, others, pictures, crowd, odd_names, linked)
