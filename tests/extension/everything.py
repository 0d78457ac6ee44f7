# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Create one of everything that the extension makes, using only its operators, small and coarse.

Imports nothing from the project: it runs in sessions where Blender has only the installed extension.
"""

from __future__ import annotations

import math
from pathlib import Path

import bpy
import numpy as np

QUICK = {"frames": 3, "resolution": 24}


def make_everything(folder: Path, only: str = "") -> dict[str, list[str]]:
    """Create one of everything in the open file.

    Parameters
    ----------
    folder : Path
        Folder for written files.
    only : str
        The kind of things to make, such as "morphs"; by default all.

    Returns
    -------
    dict
        The result of every operator, by its name and purpose.
    """
    bpy.context.scene.frame_end = 24
    # Each application at its own place, because densities and maps use the selection.
    answers: dict[str, list[str]] = {}
    makers = (_morphs, _outputs, _flat, _densities, _soft_map, _armature, _recolors, _skies, _materials)
    for make in makers:
        if only and make.__name__ != f"_{only}":
            continue
        bpy.ops.object.select_all(action="DESELECT")
        for name, answer in make(folder).items():
            answers[name] = sorted(answer)
    return answers


def _morphs(_folder: Path) -> dict[str, set[str]]:
    answers = {"bake_morph objects": _baked("objects", 0), "bake_morph player": _baked("player", 1)}
    return {**answers, "make_player": bpy.ops.convwass.make_player()}


def _outputs(folder: Path) -> dict[str, set[str]]:
    egg = _ball("pad egg", (6, 8, 0), 0.5)
    answers = {"bake_morph pad": _baked("pad", 2, egg, layout="TRIANGLE", steps=2)}
    answers["make_blend_pad"] = bpy.ops.convwass.make_blend_pad()
    # Guiding takes most of the time, so it is used only once.
    _select(_arm("volume straight", (0, 12, 0), 0.6), _arm("volume bent", (5, 12, 0), 1.5))
    answers["bake_morph volume"] = bpy.ops.convwass.bake_morph(**QUICK)
    answers["make_volume"] = bpy.ops.convwass.make_volume(folder=str(folder / "volumes"))
    answers["bake_morph cache"] = _baked("cache", 4)
    answers["make_cache"] = bpy.ops.convwass.make_cache(folder=str(folder / "caches"))
    _select(_ball("listed ball", (0, 20, 0)), _box("listed box", (3, 20, 0)))
    answers["add_morph_inputs"] = bpy.ops.convwass.add_morph_inputs()
    return answers


def _baked(output: str, place: int, *others: bpy.types.Object, **options: object) -> set[str]:
    """Bake a morph from a ball to a box and to further shapes."""
    _select(_ball(f"{output} ball", (0, 4 * place, 0)), _box(f"{output} box", (3, 4 * place, 0)), *others)
    return bpy.ops.convwass.bake_morph(**QUICK, **_transported(), **options)


def _transported() -> dict[str, str]:
    # Earlier versions had no choice of motion.
    has_motions = "motion" in bpy.ops.convwass.bake_morph.get_rna_type().properties
    return {"motion": "TRANSPORT"} if has_motions else {}


def _flat(_folder: Path) -> dict[str, set[str]]:
    texts = []
    for place, body in enumerate("AB"):
        bpy.ops.object.text_add(location=(-6, 4 * place, 0))
        texts.append(bpy.context.object)
        texts[-1].name = texts[-1].data.body = body
    _select(*texts)
    # The list of inputs, which is not empty, goes before the selection.
    return {
        "bake_morph flat": bpy.ops.convwass.bake_morph(inputs="A, B", frames=3, flat_resolution=128, **_transported())
    }


def _densities(_folder: Path) -> dict[str, set[str]]:
    answers = {}
    for place, ball_name in enumerate(("Colored", "Traveling")):
        ball = _ball(ball_name, (-12, 4 * place, 0))
        for name, side in (("A", 1), ("B", -1)):
            cap = [vertex.index for vertex in ball.data.vertices if side * vertex.co.x > 0.7]
            ball.vertex_groups.new(name=name).add(cap, 1.0, "REPLACE")
        ball.vertex_groups.active_index = 0
        _select(ball)
        answers["measure_distance"] = bpy.ops.convwass.measure_distance(first="A", second="B")
        answers["interpolate_density"] = bpy.ops.convwass.interpolate_density(groups="A, B", steps=3)
        answers["add_density_stop"] = bpy.ops.convwass.add_density_stop(which="ALL")
        if ball_name == "Colored":
            answers["bake_density"] = bpy.ops.convwass.bake_density(output="COLORS")
        else:
            answers["show_density_material"] = bpy.ops.convwass.show_density_material()
    return answers


def _soft_map(_folder: Path) -> dict[str, set[str]]:
    source, target = _box("Source", (-12, 8, 0), cuts=6), _box("Target", (-12, 12, 0), cuts=7)
    target.data.transform(((1.3, 0, 0, 0), (0, 0.8, 0, 0), (0, 0, 1.1, 0), (0, 0, 0, 1)))
    top = [vertex.index for vertex in source.data.vertices if vertex.co.z > 0.5]
    source.vertex_groups.new(name="Top").add(top, 1.0, "REPLACE")
    own = bpy.context.scene.convwass_soft_map
    own.source, own.target = source, target
    _select(source, target)
    answers = {}
    for corner in ((-1, -1, -1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1), (1, 1, 1)):
        ends = [_farthest(obj, corner) for obj in (source, target)]
        answers["add_map_pair"] = bpy.ops.convwass.add_map_pair(source_vertex=ends[0], target_vertex=ends[1])
    answers["add_morph_guide"] = bpy.ops.convwass.add_morph_guide(points='{"Source": 0, "Target": 0}')
    answers["compute_soft_map"] = bpy.ops.convwass.compute_soft_map(vertices=100, sweeps=3)
    answers["transfer_by_map"] = bpy.ops.convwass.transfer_by_map(what={"GROUPS"})
    answers["show_soft_map"] = bpy.ops.convwass.show_soft_map()
    return answers


def _armature(_folder: Path) -> dict[str, set[str]]:
    tube = _tube("Tube", (-12, 18, 0))
    rig = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    rig.location = tube.location
    bpy.context.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    parent = None
    for place in range(4):
        bone = rig.data.edit_bones.new("ABCD"[place])
        # Displaced from the tube except at its ends.
        bone.head = (1.5 * math.sin(math.pi * place / 4), 0, 0.9 * place - 1.8)
        bone.tail = (1.5 * math.sin(math.pi * (place + 1) / 4), 0, 0.9 * (place + 1) - 1.8)
        bone.parent, bone.use_connect = parent, parent is not None
        parent = bone
    bpy.ops.object.mode_set(mode="OBJECT")
    own = bpy.context.scene.convwass_armature
    own.body, own.rig = tube, rig
    _select(rig)
    return {
        "pin_joints": bpy.ops.convwass.pin_joints(joints="A.head, D.tail"),
        "fit_armature": bpy.ops.convwass.fit_armature(),
    }


def _recolors(folder: Path) -> dict[str, set[str]]:
    red, blue = _image("Red", (0.7, 0.3, 0.2)), _image("Blue", (0.2, 0.3, 0.6))
    own = bpy.context.scene.convwass_recolor
    colored = [_box(name, (-20, 8 + 4 * place, 0), cuts=3) for place, name in enumerate(("Warm", "Cold"))]
    for obj, shift in zip(colored, (0.2, 0.5), strict=True):
        colors = obj.data.color_attributes.new("Color", "FLOAT_COLOR", "POINT")
        values = np.ones((len(obj.data.vertices), 4), np.float32)
        values[:, :3] = shift + 0.2 * np.random.default_rng(2).random((len(values), 3))
        colors.data.foreach_set("color", values.ravel())
    own.palette, own.palette_object = blue, colored[1]
    _select(colored[0])
    return {
        "recolor_image": bpy.ops.convwass.recolor_image(image=red.name),
        "write_cube": bpy.ops.convwass.write_cube(image=red.name, filepath=str(folder / "grade.cube"), cube_size=9),
        "build_grade_nodes": bpy.ops.convwass.build_grade_nodes(image=red.name, cube_size=9),
        "recolor_attribute": bpy.ops.convwass.recolor_attribute(),
    }


def _skies(folder: Path) -> dict[str, set[str]]:
    for name, column in (("Morning", 8), ("Evening", 40)):
        image = bpy.data.images.new(name, 64, 32, float_buffer=True)
        pixels = np.full((32, 64, 4), (0.2, 0.3, 0.5, 1.0), np.float32)
        pixels[22:24, column : column + 2, :3] = 500.0
        image.pixels.foreach_set(pixels.ravel())
        image.pack()
        world = bpy.data.worlds.new(name)
        if world.node_tree is None:
            world.use_nodes = True
        texture = world.node_tree.nodes.new("ShaderNodeTexEnvironment")
        texture.image = image
        background = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
        world.node_tree.links.new(texture.outputs["Color"], background.inputs["Color"])
    answer = bpy.ops.convwass.blend_skies(
        worlds="Morning, Evening", folder=str(folder / "skies"), frame_start=1, frame_end=4, width=64
    )
    return {"blend_skies": answer}


def _materials(_folder: Path) -> dict[str, set[str]]:
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    bpy.context.scene.collection.objects.link(sun)
    for name, roughness, color in (("Rough", 0.7, (1, 0, 0, 1)), ("Smooth", 0.4, (0, 0, 1, 1))):
        material = bpy.data.materials.new(name)
        if material.node_tree is None:
            material.use_nodes = True
        node = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
        for key, value in (("Roughness", roughness), ("Metallic", 1.0), ("Base Color", color)):
            node.inputs[key].default_value = value
    answer = bpy.ops.convwass.blend_materials(materials="Rough, Smooth", detail=8, blends=3, frame_start=1, frame_end=4)
    # Unused data-blocks are not saved.
    for place, material in enumerate(m for m in bpy.data.materials if m.name.startswith("Blend")):
        _box(f"Sample {place}", (-20, 4 * place, 0)).data.materials.append(material)
    return {"blend_materials": answer}


def _ball(name: str, location: tuple[float, float, float], height: float = 1.0) -> bpy.types.Object:
    bpy.ops.mesh.primitive_uv_sphere_add(segments=16, ring_count=8, location=location, scale=(1, 1, height))
    bpy.context.object.name = name
    return bpy.context.object


def _box(name: str, location: tuple[float, float, float], cuts: int = 0) -> bpy.types.Object:
    bpy.ops.mesh.primitive_cube_add(location=location)
    if cuts:
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.subdivide(number_cuts=cuts)
        bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.object.name = name
    return bpy.context.object


def _tube(name: str, location: tuple[float, float, float]) -> bpy.types.Object:
    bpy.ops.mesh.primitive_cylinder_add(vertices=12, radius=0.4, depth=4, location=location)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide(number_cuts=3)
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.context.object.name = name
    return bpy.context.object


def _arm(name: str, location: tuple[float, float, float], bend: float) -> bpy.types.Object:
    """Add a tube whose upper half is bent to an arc."""
    arm, radius = _tube(name, location), 2.0 / bend
    for vertex in arm.data.vertices:
        x, y, z = vertex.co
        if z > 0.0:
            angle = 0.5 * bend * z
            vertex.co = (radius - (radius - x) * math.cos(angle), y, (radius - x) * math.sin(angle))
    return arm


def _image(name: str, color: tuple[float, float, float]) -> bpy.types.Image:
    image = bpy.data.images.new(name, 24, 16)
    pixels = np.ones((16, 24, 4), np.float32)
    pixels[..., :3] = color + 0.1 * np.random.default_rng(1).standard_normal((16, 24, 3))
    image.pixels.foreach_set(pixels.clip(0, 1).ravel())
    image.pack()
    return image


def _farthest(obj: bpy.types.Object, way: tuple[float, float, float]) -> int:
    return max(obj.data.vertices, key=lambda vertex: vertex.co.dot(way)).index


def _select(*objects: bpy.types.Object) -> None:
    bpy.ops.object.select_all(action="DESELECT")
    for obj in objects:
        obj.select_set(True)
    bpy.context.view_layer.objects.active = objects[0]
