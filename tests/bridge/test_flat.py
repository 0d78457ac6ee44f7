# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Flat objects as outlines in a plane, and outlines as curve objects."""

from __future__ import annotations

import re

import bpy
import numpy as np
import pytest
from mathutils import Euler, Matrix

from convwass_addon.applications.flat.flat_pieces import filled_by
from convwass_addon.applications.flat.flat_settings import FlatSettings
from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.bridge.flat.choosing import asks_for_flat
from convwass_addon.bridge.flat.color_notices import color_notices
from convwass_addon.bridge.flat.flat_curves import mesh_of, write_curves
from convwass_addon.bridge.flat.flat_images import silhouette_of
from convwass_addon.bridge.flat.flat_job import FlatJob
from convwass_addon.bridge.flat.flat_kinds import looks_flat
from convwass_addon.bridge.flat.flat_moves import moved_flats
from convwass_addon.bridge.flat.flat_objects import flat_objects, is_flat
from convwass_addon.bridge.flat.flat_rings import CurveStyle
from convwass_addon.bridge.flat.planes import Plane, blended_plane, plane_of
from convwass_addon.bridge.morphs.stored import frame_objects
from convwass_addon.bridge.nodes.node_trees import own_tree
from convwass_addon.bridge.objects import MESHED, triangle_mesh
from convwass_addon.errors import Cancelled, InputError
from convwass_addon.geometry.plane.fitting import fitted_beziers
from convwass_addon.geometry.plane.outlines import FlatRegion, Outline
from convwass_addon.progress import Control
from tests.scene import linked

SQUARE = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]


def text(body, **options):
    curve = bpy.data.curves.new(body or "Text", "FONT")
    curve.body = body
    for name, value in options.items():
        setattr(curve, name, value)
    return linked(curve.name, curve)


def polygon(points, *, kind="POLY", cyclic=True, dimensions="2D"):
    curve = bpy.data.curves.new("Curve", "CURVE")
    curve.dimensions = dimensions
    spline = curve.splines.new(kind)
    spline.points.add(len(points) - 1)
    spline.points.foreach_set("co", np.array([(*point, 1.0) for point in points], np.float32).ravel())
    spline.use_cyclic_u = cyclic
    return linked("Curve", curve)


def filled(points):
    obj = polygon(points)
    obj.data.fill_mode = "BOTH"
    return obj


def circle(**options):
    bpy.ops.curve.primitive_bezier_circle_add(**options)
    return bpy.context.object


def area(flat):
    return filled_by(flat.shape, np.arange(len(flat.shape.rings))).area


def read(*objects):
    return flat_objects(objects, bpy.context.evaluated_depsgraph_get())


def drawn_area(obj):
    """What Blender fills of an object."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    mesh = bpy.data.meshes.new_from_object(obj.evaluated_get(depsgraph), depsgraph=depsgraph)
    return sum(polygon.area for polygon in mesh.polygons)


@pytest.mark.parametrize("body", ["A", "B8%", "qgi!", "Straße"])
def test_a_text_fills_what_blender_fills(body):
    assert area(read(text(body))[0]) == pytest.approx(drawn_area(bpy.context.scene.objects[0]), rel=5e-3)


def test_underlines_belong_to_their_letters():
    obj = text("Öl")
    for sign in obj.data.body_format:
        sign.use_underline = True
    (flat,) = read(obj)
    assert area(flat) == pytest.approx(drawn_area(obj), rel=5e-3)
    assert sorted(flat.shape.letters) == [0, 0, 0, 0, 0, 1, 1]


def test_letters_are_numbered_in_reading_order():
    (flat,) = read(text("a B\ni8"))
    numbers = np.array(flat.shape.letters)
    assert sorted(set(numbers)) == [0, 2, 4, 5] or sorted(set(numbers)) == [0, 2, 3, 4]
    assert [int((numbers == number).sum()) for number in np.unique(numbers)] == [2, 3, 2, 3]


def test_a_circle_is_read_within_a_thousandth():
    assert area(read(circle(radius=2.0))[0]) == pytest.approx(4 * np.pi, rel=1e-3)


def test_splines_of_all_kinds_are_read_as_blender_draws_them():
    bpy.ops.curve.primitive_nurbs_circle_add()
    nurbs = bpy.context.object
    depsgraph = bpy.context.evaluated_depsgraph_get()
    points = np.array([vertex.co[:] for vertex in bpy.data.meshes.new_from_object(nurbs).vertices])
    x, y = points[:, :2].T
    expected = 0.5 * abs(x @ np.roll(y, -1) - y @ np.roll(x, -1))
    assert area(flat_objects([nurbs], depsgraph)[0]) == pytest.approx(expected, rel=1e-2)
    assert area(read(polygon(SQUARE))[0]) == pytest.approx(4.0, rel=1e-6)


def test_open_splines_whose_ends_touch_are_closed():
    assert area(read(polygon([*SQUARE, SQUARE[0]], cyclic=False))[0]) == pytest.approx(4.0, rel=1e-6)


def bend(obj):
    modifier = obj.modifiers.new("Bend", "SIMPLE_DEFORM")
    modifier.deform_method, modifier.deform_axis, modifier.angle = "BEND", "Z", 0.5
    return modifier


def stretch(obj):
    modifier = obj.modifiers.new("Stretch", "SIMPLE_DEFORM")
    modifier.deform_method, modifier.deform_axis, modifier.factor = "STRETCH", "X", 1.0
    return modifier


def repeat(obj):
    modifier = obj.modifiers.new("Repeat", "ARRAY")
    modifier.count = 3
    modifier.relative_offset_displace[0] = 1.5
    return modifier


def mirror(obj):
    modifier = obj.modifiers.new("Mirror", "MIRROR")
    modifier.mirror_object = linked("Axis", None)
    modifier.mirror_object.location.x = 9.0
    return modifier


def push(obj):
    data = bpy.data.lattices.new("Lattice")
    for point in data.points:
        point.co_deform.x *= 2.0 if point.co.y > 0 else 1.0
    modifier = obj.modifiers.new("Push", "LATTICE")
    modifier.object = linked("Lattice", data)
    modifier.object.scale = (4, 4, 4)
    return modifier


def by_nodes(obj):
    tree = bpy.data.node_groups.new("Move", "GeometryNodeTree")
    for direction in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=direction, socket_type="NodeSocketGeometry")
    kinds = ("NodeGroupInput", "GeometryNodeTransform", "NodeGroupOutput")
    begin, move, end = (tree.nodes.new(kind) for kind in kinds)
    move.inputs["Scale"].default_value = (2.0, 3.0, 1.0)
    move.inputs["Translation"].default_value = (2.0, 0.0, 0.0)
    tree.links.new(begin.outputs[0], move.inputs[0])
    tree.links.new(move.outputs[0], end.inputs[0])
    modifier = obj.modifiers.new("Nodes", "NODES")
    modifier.node_group = tree
    return modifier


def drawn_bounds(obj):
    """Bounds in world space of what Blender draws of an object, along X and Y, (2, 2)."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    mesh = bpy.data.meshes.new_from_object(obj.evaluated_get(depsgraph), depsgraph=depsgraph)
    return bounds([obj.matrix_world @ vertex.co for vertex in mesh.vertices])


def bounds(points):
    places = np.array(points)[:, :2]
    return np.array([places.min(axis=0), places.max(axis=0)])


@pytest.mark.parametrize("modify", [bend, stretch, repeat, mirror, push, by_nodes])
@pytest.mark.parametrize(
    "make", [lambda: text("E"), lambda: filled(SQUARE), circle], ids=["text", "filled", "unfilled"]
)
def test_all_modifiers_of_texts_and_curves_count(make, modify):
    obj = make()
    obj.location = (3.0, 1.0, 0.0)
    modify(obj)
    bpy.context.view_layer.update()
    (flat,) = read(obj)
    np.testing.assert_allclose(bounds(flat.read.points), drawn_bounds(obj), atol=1e-4)
    assert flat.read.notice is None
    if drawn_area(obj) > 0:
        assert area(flat) == pytest.approx(drawn_area(obj), rel=1e-3)


def test_modifiers_of_beveled_texts_count_and_the_depth_is_kept():
    plain, deep = text("E"), text("E", extrude=0.2, bevel_depth=0.01, offset=0.02)
    for obj in (plain, deep):
        repeat(obj).use_relative_offset = False
        obj.modifiers[0].use_constant_offset = True
        obj.modifiers[0].constant_offset_displace = (2.0, 0.0, 0.0)
    plain.data.offset = 0.02
    first, second = read(plain, deep)
    assert area(second) == pytest.approx(area(first), rel=1e-4)
    style = second.read.style
    assert (style.extrude, style.bevel_depth, style.offset) == pytest.approx((0.2, 0.01, 0.0))
    assert (deep.data.extrude, deep.data.bevel_depth) == pytest.approx((0.2, 0.01))


def test_texts_keep_their_letters_without_shown_modifiers():
    obj = text("AB")
    repeat(obj).show_viewport = False
    assert set(read(obj)[0].shape.letters) == {0, 1}
    obj.modifiers[0].show_viewport = True
    assert read(obj)[0].shape.letters is None


def test_modifiers_applied_on_splines_are_read_by_splines():
    obj = circle()
    obj.data.dimensions = "3D"
    stretch(obj).use_apply_on_spline = True
    (flat,) = read(obj)
    np.testing.assert_allclose(bounds(flat.read.points), drawn_bounds(obj), atol=1e-2)
    assert flat.read.notice is None
    assert flat.read.style.fill_mode == "NONE"


def test_materials_of_splines_are_kept_with_modifiers():
    obj = filled(SQUARE)
    for name in ("First", "Second"):
        obj.data.materials.append(bpy.data.materials.new(name))
    spline = obj.data.splines.new("POLY")
    spline.points.add(3)
    spline.points.foreach_set("co", np.array([(x + 5, y, z, 1) for x, y, z in SQUARE], np.float32).ravel())
    spline.use_cyclic_u, spline.material_index = True, 1
    stretch(obj)
    (flat,) = read(obj)
    left, right = sorted(zip(flat.read.rings, flat.read.slots, strict=True), key=lambda each: each[0][:, 0].mean())
    assert (left[1], right[1]) == (0, 1)


def test_modifiers_that_make_no_flat_area_are_named():
    twisted, joined = text("E"), polygon([(x + 1, y, z) for x, y, z in SQUARE], dimensions="3D")
    bend(twisted).deform_method, twisted.modifiers[0].deform_axis = "TWIST", "X"
    # The common edge of the halves is open at both ends.
    joined.modifiers.new("Mirror", "MIRROR")
    for obj in (twisted, joined):
        (flat,) = read(obj)
        name = re.escape(f"{obj.name}: blends leave out the modifier {obj.modifiers[0].name}")
        assert re.match(name, str(flat.read.notice))
        assert area(flat) > 0


def test_open_splines_among_closed_ones_are_left_out_with_a_notice():
    obj = polygon(SQUARE)
    spline = obj.data.splines.new("POLY")
    spline.points.add(1)
    spline.points[1].co.x = 3.0
    (flat,) = read(obj)
    assert area(flat) == pytest.approx(4.0, rel=1e-6)
    assert "1 open splines" in str(flat.read.notice)


def test_materials_without_a_single_color_are_named():
    plain, textured = text("A"), text("B")
    for obj, name in ((plain, "Plain"), (textured, "Marble")):
        obj.data.materials.append(bpy.data.materials.new(name))
        own_tree(obj.active_material)
    assert color_notices([plain, textured]) == []
    tree = textured.active_material.node_tree
    noise = tree.nodes.new("ShaderNodeTexNoise")
    tree.links.new(noise.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    job = flat_job(plain, textured)
    assert [str(notice) for notice in job.notices] == [str(notice) for notice in color_notices([plain, textured])]
    assert "colors of Marble (B), not" in str(job.notices[0])
    job.discard()
    plain.active_material = textured.active_material
    assert flat_job(plain, textured).notices == []


def flat_job(*objects):
    return FlatJob(objects, path_blends(len(objects), 3), FlatSettings(resolution=32), {}, 1)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: text(""), "is empty; type something"),
        (lambda: text("  \n "), "is empty; type something"),
        (lambda: text("A\ue001"), "has no \ue001; choose another font"),
        (lambda: polygon(SQUARE, cyclic=False), "only has open splines, which fill no area; close them"),
        (lambda: linked("None", bpy.data.curves.new("None", "CURVE")), "no splines"),
        (lambda: polygon([(0, 0, 0), (1, 0, 0), (2, 0, 0)]), "flattened to a line"),
        (lambda: polygon([*SQUARE[:3], (-1, 1, 1)], dimensions="3D"), "does not lie in one plane"),
    ],
)
def test_unreadable_objects_are_reported(make, message):
    obj = make()
    with pytest.raises(InputError, match=message):
        read(obj)


def test_signs_that_fonts_have_are_not_refused():
    assert len(read(text("É – ß «A»"))[0].shape.rings) > 8


def test_a_flat_mesh_is_its_border(make_object):
    grid = make_object("Ring", np.array([(x, y, 3) for x in range(4) for y in range(4)], float), faces=[])
    faces = [
        (4 * x + y, 4 * x + 4 + y, 4 * x + 5 + y, 4 * x + 1 + y) for x in range(3) for y in range(3) if (x, y) != (1, 1)
    ]
    # Every second face is flipped.
    faces = [face if index % 2 else face[::-1] for index, face in enumerate(faces)]
    grid.data.clear_geometry()
    grid.data.from_pydata([(x, y, 3) for x in range(4) for y in range(4)], [], faces)
    (flat,) = read(grid)
    assert sorted(len(ring) for ring in flat.shape.rings) == [4, 12]
    assert area(flat) == pytest.approx(8.0, rel=1e-6)
    assert is_flat(grid, bpy.context.evaluated_depsgraph_get())
    assert flat.plane.origin[2] == pytest.approx(3.0)


def test_flat_meshes_are_recognized_anywhere(make_object):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    flat = make_object("Flat", SQUARE, faces=[(0, 1, 2, 3)])
    flat.matrix_world = Matrix.LocRotScale((5, 6, 7), Euler((0.4, 0.5, 0.6)), (2, 1, 0))
    assert is_flat(flat, depsgraph)
    assert looks_flat(flat)
    assert not is_flat(make_object("Solid"), depsgraph)
    assert not is_flat(make_object("Edges", SQUARE, [(0, 1)]), depsgraph)


def test_modifiers_count(make_object):
    flat = make_object("Flat", SQUARE, faces=[(0, 1, 2, 3)])
    flat.modifiers.new("Array", "ARRAY").count = 3
    assert area(read(flat)[0]) == pytest.approx(12.0, rel=1e-5)
    flat.modifiers.new("Solidify", "SOLIDIFY")
    assert not is_flat(flat, bpy.context.evaluated_depsgraph_get())


def painted(values, name="Picture"):
    """An image empty of values (h, w), or (h, w, 4)."""
    values = np.asarray(values, np.float32)
    pixels = values if values.ndim == 3 else np.stack([values] * 3 + [np.ones_like(values)], axis=-1)
    image = bpy.data.images.new(name, pixels.shape[1], pixels.shape[0], alpha=True)
    image.pixels.foreach_set(np.ascontiguousarray(pixels).ravel())
    obj = linked(name, None)
    obj.empty_display_type, obj.data = "IMAGE", image
    return obj


def disc():
    """A disc with a radius of 30 pixels."""
    y, x = np.mgrid[:96, :128]
    return np.clip(30.5 - np.hypot(x - 63.5, y - 47.5), 0, 1)


@pytest.mark.parametrize("how", ["black on white", "white on black", "alpha"])
def test_silhouettes_of_images_are_read(how):
    mask = disc()
    if how == "alpha":
        obj = painted(np.dstack([np.ones((*mask.shape, 3)), mask]))
    else:
        obj = painted(1 - mask if how == "black on white" else mask)
    obj.empty_display_size = 2.0
    (flat,) = read(obj)
    pixel = 2.0 / 128
    assert area(flat) == pytest.approx(np.pi * (30 * pixel) ** 2, rel=5e-3)
    np.testing.assert_allclose(flat.plane.origin, 0.0, atol=0.5 * pixel)


def test_images_without_a_figure_are_refused():
    with pytest.raises(InputError, match="is uniform"):
        read(painted(np.ones((8, 8))))
    with pytest.raises(InputError, match="could not be read"):
        silhouette_of(_missing())


def _missing():
    image = bpy.data.images.new("Gone", 4, 4)
    image.source = "FILE"
    image.filepath = "/nowhere/gone.png"
    return image


def test_parallel_shapes_share_axes_and_others_keep_their_own():
    one, other, turned = text("A"), text("B"), text("C")
    other.matrix_world = Matrix.LocRotScale((4, 0, 2), Euler((0, 0, 1.0)), (1, 1, 1))
    turned.rotation_euler.x = np.pi / 2
    bpy.context.view_layer.update()
    first, second, third = read(one, other, turned)
    np.testing.assert_allclose(first.plane.axes, second.plane.axes)
    np.testing.assert_allclose(second.plane.origin - first.plane.origin, (0, 0, 2), atol=1e-6)
    np.testing.assert_allclose(third.plane.axes[:, 2], (0, -1, 0), atol=1e-6)
    assert area(second) == pytest.approx(drawn_area(other), rel=5e-3)


def test_shapes_that_are_tilted_about_two_axes_lie_in_a_plane(make_object):
    """Unless they are symmetric, the middle of their bounds does not."""
    tilt = Euler((1.2, 0.3, 0.5)).to_matrix().to_4x4()
    letter, corner = text("F"), make_object("Corner", np.eye(3), faces=[(0, 1, 2)])
    letter.matrix_world = corner.matrix_world = Matrix.Translation((4, 5, 6)) @ tilt
    bpy.context.view_layer.update()
    assert is_flat(corner, bpy.context.evaluated_depsgraph_get())
    for flat in read(letter, corner):
        points = flat.read.points - flat.plane.origin
        np.testing.assert_allclose(points @ flat.plane.axes[:, 2], 0.0, atol=1e-6)
        assert np.abs(points).max() < 1.5
    assert area(read(letter)[0]) == pytest.approx(drawn_area(letter), rel=5e-3)


def test_planes_turn_the_short_way():
    ends = [Plane(np.zeros(3), np.array(Euler((angle, 0, 0)).to_matrix())) for angle in (0.0, np.pi / 2)]
    middle = blended_plane(ends, (0.5, 0.5))
    np.testing.assert_allclose(middle.axes, np.array(Euler((np.pi / 4, 0, 0)).to_matrix()), atol=1e-6)


def test_planes_keep_to_the_axes_of_their_object():
    points = np.random.default_rng(1).normal(size=(50, 3))
    points[:, 1] = 4.0
    plane = plane_of(points, np.eye(4))
    np.testing.assert_allclose(np.abs(plane.axes[:, 2]), (0, 1, 0), atol=1e-9)
    np.testing.assert_allclose(plane.axes[:, 0], (1, 0, 0), atol=1e-9)
    assert np.linalg.det(plane.axes) == pytest.approx(1.0)
    assert plane_of(np.random.default_rng(2).normal(size=(50, 3)), np.eye(4)) is None


def test_shapes_are_laid_onto_the_first_one():
    corners = np.array([(0, 0, 0), (6, 0, 0), (6, 2, 0), (0, 1, 0)], float)
    near, far = polygon(corners), polygon(corners / 2)
    far.data.extrude = 0.5
    far.matrix_world = Matrix.LocRotScale((9, 9, 3), Euler((0, 0, 2.0)), (1, 1, 1))
    bpy.context.view_layer.update()
    first, second = moved_flats(read(near, far), "PRINCIPAL_AXES", "EQUAL_VOLUME")
    np.testing.assert_allclose(second.shape.rings[0], first.shape.rings[0], atol=1e-4)
    assert second.style.extrude == pytest.approx(1.0, rel=1e-4)
    moved = Matrix(second.move.tolist()) @ far.matrix_world
    np.testing.assert_allclose(np.array(moved.translation), (0, 0, 0), atol=1e-3)


def test_flat_and_solid_shapes_are_not_mixed_without_a_thickness(make_object):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    solid, flat, plane = make_object("Solid"), text("A"), make_object("Plane", SQUARE, faces=[(0, 1, 2, 3)])
    with pytest.raises(InputError, match=r"A is flat but Solid is solid; .* set Thickness"):
        asks_for_flat([solid, flat], depsgraph, 0.0)
    assert not asks_for_flat([solid, flat, plane], depsgraph, 0.1)
    assert asks_for_flat([flat, plane], depsgraph, 0.0)
    assert not asks_for_flat([plane, plane], depsgraph, 0.1)
    assert not asks_for_flat([solid, solid], depsgraph, 0.0)
    flat.data.extrude = 0.2
    assert not asks_for_flat([solid, flat], depsgraph, 0.0)
    with pytest.raises(InputError, match="cannot be made solid"):
        asks_for_flat([solid, painted(disc())], depsgraph, 0.1)


def test_wires_are_not_called_solid(make_object):
    """Reading them says what they lack."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    wire, plane = make_object("Wire", SQUARE, faces=[]), make_object("Plane", SQUARE, faces=[(0, 1, 2, 3)])
    assert not asks_for_flat([plane, wire], depsgraph, 0.0)
    with pytest.raises(InputError, match="Wire has points but no faces"):
        triangle_mesh(wire, depsgraph, MESHED)


@pytest.mark.parametrize("thickness", [0.0, 0.1])
@pytest.mark.parametrize("depth", [0.0, 0.1])
def test_a_scale_of_zero_among_solid_shapes_is_named(make_object, thickness, depth):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    solid, gem, word = make_object("Solid"), make_object("Gem"), text("A", extrude=depth)
    gem.scale.z = word.scale.z = 0.0
    for flat in (gem, word):
        with pytest.raises(InputError, match=rf"{flat.name} has a scale of zero, so it has no volume; give it another"):
            asks_for_flat([solid, flat], depsgraph, thickness)
    assert asks_for_flat([gem, word], depsgraph, 0.0)


@pytest.mark.parametrize("far", [1e4, 1e30])
def test_a_vertex_that_is_far_away_from_a_solid_is_named(make_object, far):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    solid, stray, plane = make_object("Solid"), make_object("Stray"), make_object("Plane", SQUARE, faces=[(0, 1, 2, 3)])
    stray.data.vertices[5].co.x = plane.data.vertices[2].co.x = far
    with pytest.raises(InputError, match="Stray looks flat, because 1 of its 6 vertices are very far away"):
        asks_for_flat([solid, stray], depsgraph, 0.0)
    with pytest.raises(InputError, match="Plane is flat but Solid is solid"):
        asks_for_flat([solid, plane], depsgraph, 0.0)


def test_an_outline_becomes_a_curve_that_blender_fills():
    angle = np.linspace(0, 2 * np.pi, 300, endpoint=False)
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    outline = Outline((FlatRegion(2.0 * ring, (ring[::-1],)),))
    curve = bpy.data.curves.new("Ring", "CURVE")
    write_curves(curve, fitted_beziers(outline, 1e-3), CurveStyle(extrude=0.25))
    assert all(spline.use_cyclic_u and len(spline.bezier_points) < 30 for spline in curve.splines)
    mesh = mesh_of(bpy.data.objects.new("Ring", curve))
    low, high = (np.array([vertex.co[:] for vertex in mesh.vertices])[:, 2].min(), 0.25)
    assert low == pytest.approx(-high)
    caps = sum(face.area for face in mesh.polygons if abs(face.normal.z) > 0.9)
    assert caps == pytest.approx(2 * 3 * np.pi, rel=5e-3)


def drawing(rings, fills):
    """A drawing of strokes with given fill numbers; 0 is not filled."""
    lists = bpy.data.grease_pencils_v3 if hasattr(bpy.data, "grease_pencils_v3") else bpy.data.grease_pencils
    data = lists.new("Drawing")
    for name, filled in (("Line", False), ("Fill", True)):
        material = bpy.data.materials.new(name)
        bpy.data.materials.create_gpencil_data(material)
        if bpy.app.version < (5, 2):
            material.grease_pencil.show_fill = filled
        material.grease_pencil.fill_color = (0.1, 0.2, 0.3, 1.0)
        data.materials.append(material)
    strokes = data.layers.new("Layer").frames.new(1).drawing
    strokes.add_strokes([len(ring) for ring in rings])
    for ring, fill, stroke in zip(rings, fills, strokes.strokes, strict=True):
        for (x, y), point in zip(ring, stroke.points, strict=True):
            point.position = (x, 0.0, y)
        stroke.material_index = int(fill > 0)
        if hasattr(stroke, "fill_id"):
            stroke.fill_id = fill
    return linked("Drawing", data)


def square(size, x=0.0):
    return size * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) / 2 + (x, 0.0)


def test_filled_strokes_of_a_drawing_lie_over_each_other():
    # Two that overlap, in opposite directions, and a line.
    obj = drawing([square(2.0), square(2.0, 1.0)[::-1], square(9.0)], [1, 2, 0])
    (flat,) = read(obj)
    assert area(flat) == pytest.approx(6.0, rel=1e-6)
    np.testing.assert_allclose(flat.shape.colors, [(0.1, 0.2, 0.3, 1.0)] * 2, atol=1e-6)
    np.testing.assert_allclose(np.abs(flat.plane.axes[:, 2]), (0, 1, 0), atol=1e-6)


@pytest.mark.skipif(bpy.app.version < (5, 2), reason="Each stroke is filled by itself")
def test_strokes_of_one_fill_make_holes():
    assert area(read(drawing([square(4.0), square(2.0)], [3, 3]))[0]) == pytest.approx(12.0, rel=1e-6)


def test_drawings_without_fills_are_refused():
    with pytest.raises(InputError, match="no filled stroke"):
        read(drawing([square(2.0)], [0]))


def test_a_stopped_job_keeps_finished_frames():
    letters = [text("A"), text("B")]
    settings = FlatSettings(resolution=128, motion="transport")
    job = FlatJob(letters, path_blends(2, 9), settings, {}, 1)
    control, frames = Control(), 0
    with pytest.raises(Cancelled):
        for step in job.steps(control, Computation(workers=1)):
            job.write(step)
            frames += step.payload is not None
            if frames == 3:
                control.cancel()
    collection = job.finish(hide_inputs=False)
    shown = frame_objects(collection)
    assert 3 <= len(shown) < 10
    bpy.context.scene.frame_set(30)
    assert [obj.hide_render for obj in shown] == [True] * (len(shown) - 1) + [False]


def test_a_discarded_job_leaves_nothing_behind(inventory):
    letters = [text("A"), text("B")]
    before = inventory()
    for kind in ("CURVE", "MESH"):
        job = FlatJob(
            letters,
            path_blends(2, 2),
            FlatSettings(resolution=128, motion="transport"),
            {"flat_output": kind},
            1,
        )
        for step in job.steps():
            job.write(step)
        job.discard()
        assert inventory() == before
