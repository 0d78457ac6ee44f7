# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from convwass_addon.errors import InputError
from convwass_addon.geometry.meshes.centroid import centroid
from convwass_addon.geometry.meshes.edges import mesh_edges, topology
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.mirror_planes import mirror_planes
from convwass_addon.geometry.meshes.welding import welded
from convwass_addon.geometry.solids.orientation import orient_outward
from convwass_addon.geometry.solids.solid_angles import winding_numbers
from tests.shapes import ball, box, joined, piece_count, square, torus, with_faces


def test_measures_of_a_box():
    mesh = box((1, 2, 3), center=(5, -4, 2), angles=(0.3, 0.5, 0.7))
    assert mesh.volume == pytest.approx(6)
    assert mesh.area == pytest.approx(22)
    np.testing.assert_allclose(centroid(mesh), (5, -4, 2), atol=1e-12)
    np.testing.assert_allclose(mesh.moved((1, 1, 1)).bounds, mesh.bounds + 1)
    assert mesh.flipped().volume == pytest.approx(-6)
    upright = box((1, 2, 3), center=(5, -4, 2))
    assert (upright.longest_side, upright.diagonal) == pytest.approx((3, 14**0.5))


def test_single_precision_is_converted_once():
    """Shares of an area in single precision do not add up to one."""
    mesh = ball(points=3000)
    single = TriangleMesh(1.7 * mesh.vertices.astype(np.float32), mesh.faces.astype(np.int32))
    assert (single.vertices.dtype, single.faces.dtype) == (np.float64, np.int64)
    assert isinstance(mirror_planes(single), list)
    again = TriangleMesh(single.vertices, single.faces)
    assert again.vertices is single.vertices
    assert again.faces is single.faces


def test_areas_of_vertices_are_thirds_of_triangles():
    mesh = TriangleMesh.from_arrays([(0, 0, 0), (2, 0, 0), (0, 3, 0), (9, 9, 9)], [(0, 1, 2)])
    np.testing.assert_allclose(mesh.vertex_areas, (1, 1, 1, 0))
    assert torus().vertex_areas.sum() == pytest.approx(torus().area)


def test_the_centroid_is_that_of_the_solid():
    mesh = joined(box((1, 1, 1)), box((2, 2, 2), center=(10, 0, 0)))
    np.testing.assert_allclose(centroid(mesh), (10 * 8 / 9, 0, 0), atol=1e-12)
    np.testing.assert_allclose(centroid(square(center=(1, 2, 3))), (1, 2, 3))


@pytest.mark.parametrize(
    ("mesh", "components", "euler", "closed"),
    [
        (box(), 1, 2, True),
        (torus(), 1, 0, True),
        (joined(ball(), torus(center=(5, 0, 0))), 2, 2, True),
        (square(), 1, 1, False),
        (with_faces(box(), slice(0, 11)), 1, 1, False),
    ],
)
def test_topology(mesh, components, euler, closed):
    found = topology(mesh)
    assert (piece_count(mesh), found.euler, found.closed) == (components, euler, closed)


def test_edges_are_listed_once_and_in_order():
    found = mesh_edges(np.array([(2, 1, 0), (1, 2, 3), (3, 3, 0), (2, 0, 1)]))
    np.testing.assert_array_equal(found, [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)])


def test_three_faces_on_an_edge_are_counted():
    fin = TriangleMesh.from_arrays(np.eye(5, 3), [(0, 1, 2), (1, 0, 3), (0, 1, 4)])
    assert topology(fin).uneven_edges == 1


@pytest.mark.parametrize("share", [0.1, 0.3, 0.5])
def test_randomly_flipped_faces_are_reoriented(share):
    mesh = torus(segments=(80, 40))
    turned = np.random.default_rng(0).random(len(mesh.faces)) < share
    faces = mesh.faces.copy()
    faces[turned] = faces[turned, ::-1]
    mended = orient_outward(TriangleMesh(mesh.vertices, faces))
    assert topology(mended).closed
    assert mended.volume == pytest.approx(mesh.volume)


def test_of_two_components_only_the_one_whose_faces_disagree_is_changed():
    """The consistent one is last, and is a cavity."""
    outer, cavity = ball(), ball(0.6).flipped()
    faces = outer.faces.copy()
    faces[::3] = faces[::3, ::-1]
    hollow = orient_outward(joined(TriangleMesh(outer.vertices, faces), cavity))
    np.testing.assert_array_equal(hollow.faces, joined(outer, cavity).faces)


@pytest.mark.parametrize("inward", ["neither", "both"])
def test_both_halves_of_a_solid_that_passes_through_itself_face_outward(inward):
    """As where Blender's Skin modifier attaches legs: seen by their edges, one of them is inside out."""
    sphere = ball(points=4000)
    x, y, z = sphere.vertices.T
    pinched = TriangleMesh(np.stack([x, y * np.tanh(5.0 * x), z], axis=1), sphere.faces)
    mirrored = pinched.corners.mean(axis=1)[:, 0] < 0.0
    halves = TriangleMesh(pinched.vertices, np.where(mirrored[:, None], pinched.faces[:, ::-1], pinched.faces))
    mended = orient_outward(halves if inward == "neither" else halves.flipped())
    np.testing.assert_array_equal(np.sort(mended.faces, axis=1), np.sort(sphere.faces, axis=1))
    np.testing.assert_allclose(winding_numbers([(-0.5, 0.0, 0.0), (0.5, 0.0, 0.0)], mended), 1.0, atol=0.02)
    expected, _ = quad(lambda x: 2.0 * np.pi * (1.0 - x**2) * np.tanh(5.0 * x), 0.0, 1.0)
    assert mended.volume == pytest.approx(expected, rel=0.01)
    np.testing.assert_array_equal(orient_outward(mended).faces, mended.faces)


def test_an_open_sheet_with_some_faces_flipped_is_consistent():
    """Winding numbers are half in front of it, and half behind it."""
    hull = ball()
    sheet = with_faces(hull, hull.corners.mean(axis=1)[:, 2] > 0.9)
    turned = sheet.corners.mean(axis=1)[:, 0] < 0.1
    faces = np.where(turned[:, None], sheet.faces[:, ::-1], sheet.faces)
    mended = orient_outward(TriangleMesh(sheet.vertices, faces))
    assert topology(mended).uneven_edges == 0


def test_inside_out_solids_are_flipped():
    assert orient_outward(ball().flipped()).volume == pytest.approx(ball().volume)


def test_one_inside_out_component_is_flipped():
    mesh = joined(ball(), box(center=(4, 0, 0)).flipped())
    assert orient_outward(mesh).volume == pytest.approx(ball().volume + 1)


def test_a_cavity_stays_a_cavity():
    hollow = joined(ball(1.0), ball(0.6).flipped())
    assert orient_outward(hollow).volume == pytest.approx(ball(1.0).volume - ball(0.6).volume)


@pytest.mark.parametrize("size", [1.0, 1e-3, 1e3])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_cavity_that_ends_at_the_surface_stays_one(side, size):
    """Half of its corners are on the surface, or just beyond it."""
    hollow = joined(box(), box((0.5, 0.5, 0.5), (0.0, 0.0, side * 0.25025)).flipped())
    found = orient_outward(TriangleMesh(size * hollow.vertices, hollow.faces))
    assert found.volume == pytest.approx(size**3 * (1.0 - 0.125))


def in_two_pieces(mesh):
    """A ring whose inner wall has vertices of its own, as Blender's solid text has."""
    inner = (np.linalg.norm(mesh.corners[..., :2], axis=2) <= 1.0 + 1e-9).all(axis=1)
    return joined(with_faces(mesh, inner), with_faces(mesh, ~inner)), int(inner.sum())


def test_the_wall_of_a_hole_is_no_body_of_its_own():
    ring, _ = in_two_pieces(torus())
    assert orient_outward(ring) is ring


def test_pieces_that_meet_in_a_seam_are_made_consistent():
    ring, walls = in_two_pieces(torus())
    faces = ring.faces.copy()
    faces[:walls] = faces[:walls, ::-1]
    np.testing.assert_array_equal(orient_outward(TriangleMesh(ring.vertices, faces)).faces, ring.faces)


def test_a_copy_of_an_open_piece_in_its_place_keeps_its_orientation():
    """A bowl that was duplicated by mistake is filled twice as much, not emptied."""
    whole = ball(points=300)
    bowl = with_faces(whole, whole.corners[:, :, 2].max(axis=1) < 0.5)
    twice = orient_outward(joined(bowl, bowl))
    assert twice.volume == pytest.approx(2.0 * orient_outward(bowl).volume)
    assert winding_numbers(np.array([[0.0, 0.0, -0.5]]), twice)[0] > 1.5


def test_solids_that_share_a_vertex_are_oriented_one_by_one():
    small, large = box(), TriangleMesh(2.0 * box().vertices + 1.5, box().faces).flipped()
    touching = welded(joined(small, large))
    assert len(touching.vertices) == 15
    assert orient_outward(touching).volume == pytest.approx(9.0)


def test_of_solids_that_touch_only_the_one_that_is_inside_out_is_flipped():
    boxes = joined(box(), box(center=(1.0, 0.0, 0.0)).flipped(), with_faces(box(center=(4.0, 0.0, 0.0)), slice(11)))
    assert orient_outward(boxes).volume == pytest.approx(2.0 + boxes.face_volumes[24:].sum())


def test_a_moebius_strip_is_unchanged():
    n = 40
    angle = np.arange(n) * 2 * np.pi / n
    across = np.array([-0.3, 0.3])[:, None]
    radius = 1 + across * np.cos(angle / 2)
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle), across * np.sin(angle / 2)], -1).reshape(-1, 3)
    low, high = np.arange(n), np.arange(n) + n
    after_low, after_high = np.r_[low[1:], high[0]], np.r_[high[1:], low[0]]
    faces = np.concatenate([np.stack([low, after_low, high], 1), np.stack([high, after_low, after_high], 1)])
    mended = orient_outward(TriangleMesh.from_arrays(points, faces))
    assert len(mended.faces) == 2 * n


def test_winding_number_counts_solids():
    overlapping = joined(ball(), ball(center=(0.5, 0, 0)))
    points = [(x, 0.01, 0.02) for x in (-2.0, -0.8, 0.25, 1.3)]
    np.testing.assert_allclose(winding_numbers(points, overlapping), [0.0, 1.0, 2.0, 1.0], atol=1e-6)


@pytest.mark.parametrize(
    ("vertices", "faces", "message"),
    [
        ([(0, 0, np.nan)] * 3, [(0, 1, 2)], "not numbers"),
        ([(0, 0, 0)] * 3, [(0, 1, 3)], "do not exist"),
        ([(0, 0)] * 3, [(0, 1, 2)], "shape"),
    ],
)
def test_invalid_arrays_are_refused(vertices, faces, message):
    with pytest.raises(InputError, match=message):
        TriangleMesh.from_arrays(vertices, faces)
