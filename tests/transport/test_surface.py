# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.errors import InputError
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.transport import KernelTooNarrowError, Surface, barycenter, distance, point_distances
from convwass_addon.transport.log_range import LOG_NOTHING
from tests.shapes import ball, box, joined, torus, with_faces
from tests.transport.sheets import sheet, sheet_mesh, strip
from tests.transport.spheres import angles, cap, icosphere, sphere

FINS = TriangleMesh.from_arrays(
    [(1, 0, 0), (0, 1, 0), (0.4, 0.5, 1), (0.5, 0.5, -0.7), (-0.2, -0.3, 0), (1.2, 1, 0.3)],
    [(0, 1, 2), (1, 0, 3), (0, 1, 4), (0, 1, 5)],
)
"""Four triangles on one edge."""


def needles() -> TriangleMesh:
    """A ball stretched to a hundred times its width."""
    mesh = ball(points=200)
    return TriangleMesh.from_arrays(mesh.vertices * (0.01, 0.01, 1), mesh.faces)


def with_loose_ends() -> TriangleMesh:
    """A ball with unused vertices, triangles that repeat a vertex, and triangles without area."""
    mesh = ball(points=150)
    vertices = np.concatenate([[(9, 9, 9)], mesh.vertices, [(7, 7, 7), 0.5 * (mesh.vertices[3] + mesh.vertices[40])]])
    return TriangleMesh.from_arrays(
        vertices, np.concatenate([mesh.faces + 1, [(5, 5, 6), (9, 9, 9), (151, 151, 0), (4, 41, 152)]])
    )


MESHES = {
    "ball": ball(points=300),
    "torus": torus(segments=(24, 12)),
    "box": box((1, 2, 3)),
    "one triangle": TriangleMesh.from_arrays(np.eye(3), [(0, 1, 2)]),
    "open": with_faces(ball(points=300), ball(points=300).vertices[ball(points=300).faces][:, :, 2].min(axis=1) > -0.2),
    "sheet": sheet_mesh(14, 9),
    "fins": FINS,
    "needles": needles(),
    "loose ends": with_loose_ends(),
    "twice": TriangleMesh.from_arrays(ball(points=80).vertices, np.repeat(ball(points=80).faces, 2, axis=0)),
    "turned over": ball(points=80).flipped(),
    "pieces": joined(ball(points=100), torus(center=(4, 0, 0), segments=(16, 8)), sheet_mesh(5, 5).moved((0, 9, 0))),
}


@pytest.fixture(params=MESHES, scope="module")
def mesh(request):
    return MESHES[request.param]


@pytest.fixture(params=[(0.003, 10), (0.05, 1), (2.0, 4)], ids=["narrow", "one step", "wide"], scope="module")
def surface(request, mesh):
    gamma, steps = request.param
    return Surface(mesh.vertices, mesh.faces, gamma, steps)


def columns_on(surface, count=3, seed=0):
    """Uneven nonnegative densities with holes."""
    rng = np.random.default_rng(seed)
    columns = rng.random((count, *surface.shape)) * (rng.random((count, *surface.shape)) < 0.7)
    columns[:, np.argmax(surface.weights)] += 0.1
    return columns


def dense_kernel(surface):
    """H as a matrix over the used vertices, by NumPy's dense solver."""
    used = surface.weights > 0
    areas = np.diag(surface.weights[used])
    stiffness = surface.laplacian.matrix.toarray()[np.ix_(used, used)]
    step = np.linalg.solve(areas + surface.gamma / (4 * surface.steps) * stiffness, areas)
    return np.linalg.matrix_power(step, surface.steps) / surface.weights[used]


def test_weights(surface):
    assert surface.weights.sum() == pytest.approx(1, abs=1e-12)
    used = np.isin(np.arange(surface.shape[0]), surface.mesh.faces[_proper(surface.mesh.faces)])
    np.testing.assert_array_equal(surface.weights > 0, used)
    assert surface.area == pytest.approx(surface.mesh.area, rel=1e-4)  # mollified needles have slightly more
    assert surface.unit_length == pytest.approx(np.sqrt(surface.area))


def _proper(faces):
    a, b, c = faces.T
    return (a != b) & (b != c) & (c != a)


def test_apply_is_the_given_number_of_implicit_euler_steps(surface):
    """Compared with NumPy's dense solver, up to rounding times the condition number of the system."""
    used = surface.weights > 0
    columns = columns_on(surface)
    found = surface.apply(columns)
    expected = (columns * surface.weights)[:, used] @ dense_kernel(surface).T
    np.testing.assert_allclose(found[:, used], expected, rtol=1e-7)
    assert (found[:, ~used] == 0).all()


def test_apply_keeps_mass_and_constants(surface):
    columns = columns_on(surface)
    np.testing.assert_allclose(surface.apply(columns) @ surface.weights, columns @ surface.weights, rtol=1e-9)
    np.testing.assert_allclose(surface.apply(np.full(surface.shape, 3.0)), np.where(surface.weights > 0, 3, 0), 1e-9)


def test_apply_is_symmetric_and_linear(surface):
    x, y = columns_on(surface, 2)
    hx, hy, both = surface.apply([x, y, 2 * x - 0.5 * y])
    assert (surface.weights * y) @ hx == pytest.approx((surface.weights * x) @ hy, rel=1e-9)
    np.testing.assert_allclose(both, 2 * hx - 0.5 * hy, rtol=1e-9, atol=1e-12 * hx.max())
    np.testing.assert_allclose(surface.apply(x), hx, rtol=1e-13)


def test_heat_is_nonnegative_and_positive_on_the_whole_component(surface):
    used = np.flatnonzero(surface.weights)
    peaks = np.zeros((len(used), *surface.shape))
    peaks[np.arange(len(used)), used] = 1 / surface.weights[used]
    heat = surface.apply(peaks)[:, used]
    pieces = np.zeros(len(used)) if surface.pieces is None else surface.pieces[used]
    np.testing.assert_array_equal(heat > 0, pieces[:, None] == pieces)
    assert (heat[pieces[:, None] != pieces] == 0).all()
    np.testing.assert_allclose(heat, heat.T, rtol=1e-6)


def test_log_apply_is_the_logarithm_of_apply(surface):
    columns = columns_on(surface)
    logs = np.full(columns.shape, LOG_NOTHING)
    np.log(columns, out=logs, where=columns > 0)
    heat = surface.apply(columns)
    expected = np.full(heat.shape, LOG_NOTHING)
    np.log(heat, out=expected, where=heat > 0)
    out, one = np.full(columns.shape, np.nan), np.full(surface.shape, np.nan)
    surface.log_apply(logs, out)
    surface.log_apply(logs[1], one)
    np.testing.assert_allclose(out, expected, rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(one, expected[1], rtol=1e-10, atol=1e-10)
    surface.log_apply(logs, logs)
    np.testing.assert_array_equal(logs, out)


def test_log_apply_far_agrees_where_both_reach(surface):
    """With a dense matrix of logarithms, for scalings of over a thousand nats; to 1e-9 of their size."""
    rng = np.random.default_rng(3)
    logs = rng.uniform(-500, 500, (3, *surface.shape))
    logs[rng.random(logs.shape) < 0.3] = LOG_NOTHING
    near, far = np.full(logs.shape, np.nan), np.full(logs.shape, np.nan)
    surface.log_apply(logs, near)
    surface.log_apply_far(logs, far)
    reached = near > LOG_NOTHING
    assert reached.any()
    np.testing.assert_allclose(far[reached], near[reached], atol=1e-7)
    np.testing.assert_array_equal(reached[:, surface.weights == 0], False)
    assert (far[:, surface.weights == 0] == LOG_NOTHING).all()
    surface.log_apply_far(logs, logs)
    np.testing.assert_array_equal(logs, far)


def test_log_apply_of_nothing_is_nothing(surface):
    for log_apply in (surface.log_apply, surface.log_apply_far):
        out = np.zeros((2, *surface.shape))
        logs = np.full((2, *surface.shape), LOG_NOTHING)
        logs[0] = 0.0
        log_apply(logs, out)
        np.testing.assert_allclose(out[0, surface.weights > 0], 0, atol=1e-9)
        assert (out[1] <= LOG_NOTHING / 2).all()


def test_the_kernel_of_a_sphere_is_its_series():
    """sum (2 l + 1) (1 + t l (l + 1) / m)^-m P_l(cos), at time t = gamma / 4 in lengths of the unit area.

    Relative errors where the heat is above 1e-4 of its peak; they decrease quadratically with the edge length.
    """
    errors = []
    for level in (4, 5):
        surface = sphere(level, 0.0145)
        peak = np.zeros(surface.shape)
        peak[0] = 1 / surface.weights[0]
        exact = series(np.cos(angles(surface, surface.positions[0])), 0.0145, 10)
        near = exact > 1e-4 * exact.max()
        errors.append(np.abs(surface.apply(peak)[near] / exact[near] - 1).max())
    print(f"kernel of the sphere: errors {np.round(errors, 4)}, rate {np.log2(errors[0] / errors[1]):.2f}")
    assert errors[1] < 0.05
    assert 1.8 < np.log2(errors[0] / errors[1]) < 2.3


def series(cosine, gamma, steps):
    time = gamma / 4 * 4 * np.pi  # the unit sphere has the area 4 pi
    degrees = np.arange(120)
    factors = (2 * degrees + 1) * (1 + time / steps * degrees * (degrees + 1)) ** -float(steps)
    return np.polynomial.legendre.legval(cosine, factors)


@pytest.mark.parametrize(("gamma", "steps"), [(0.003, 10), (0.05, 3), (1.0, 1)])
def test_waves_of_a_square_decay_by_their_eigenvalue(gamma, steps):
    """Cosines keep their shape, since no heat leaves through the boundary; accurate to 2 % on 24 cells."""
    surface = sheet(24, gamma=gamma, steps=steps)
    x, y, _ = surface.positions.T
    wave = np.cos(2 * np.pi * x) * np.cos(np.pi * y)
    eigenvalue = 5 * np.pi**2
    found = np.log((wave * surface.weights) @ surface.apply(wave) / ((wave * surface.weights) @ wave))
    assert found == pytest.approx(-steps * np.log1p(gamma / 4 / steps * eigenvalue), rel=0.02)


def test_the_default_gamma_depends_on_the_edge_length():
    coarse, fine = (Surface(mesh.vertices, mesh.faces) for mesh in (icosphere(2), icosphere(5)))
    assert coarse.gamma == pytest.approx(0.7 * coarse.mean_edge_length)
    assert fine.gamma == 0.01 > 0.7 * fine.mean_edge_length
    assert coarse.with_kernel().gamma == coarse.gamma
    # The triangles on the unit sphere are nearly equilateral; the expected edge length follows from their area.
    expected = np.sqrt(4 / np.sqrt(3) / len(icosphere(5).faces))
    assert fine.mean_edge_length == pytest.approx(expected, rel=0.01)


def test_another_kernel_on_the_same_mesh():
    mesh = MESHES["torus"]
    first = Surface(mesh.vertices, mesh.faces, 0.02, 10)
    other, fresh = first.with_kernel(0.005, 3), Surface(mesh.vertices, mesh.faces, 0.005, 3)
    assert other.laplacian is first.laplacian
    assert (other.gamma, other.steps, first.gamma, first.steps) == (0.005, 3, 0.02, 10)
    column = columns_on(first, 1)
    np.testing.assert_array_equal(other.apply(column), fresh.apply(column))
    assert np.abs(other.apply(column) - first.apply(column)).max() > 1e-3
    assert (other.coarser(), other.has_quadratic_cost, other.positions is first.positions) == (None, False, True)


def moved(mesh, change):
    return TriangleMesh.from_arrays(change(mesh.vertices), mesh.faces)


def two_densities(surface):
    first, second = columns_on(surface, 2, seed=5)
    return first, second


@pytest.mark.parametrize("scale", [1e-60, 1e-9, 1e6, 1e60])
def test_the_unit_of_length_changes_lengths_only(scale):
    mesh = MESHES["torus"]
    small, large = Surface(mesh.vertices, mesh.faces), Surface(mesh.vertices * scale, mesh.faces)
    assert large.gamma == pytest.approx(small.gamma, rel=1e-12)
    assert large.area == pytest.approx(small.area * scale**2, rel=1e-12, abs=0)
    first, second = two_densities(small)
    near, far = (distance(first, second, surface) for surface in (small, large))
    assert far.length == pytest.approx(scale * near.length, rel=1e-8, abs=0)
    assert far.entropic_value == pytest.approx(scale**2 * near.entropic_value, rel=1e-8, abs=0)
    blends = [barycenter([first, second], [0.3, 0.7], surface).density for surface in (small, large)]
    np.testing.assert_allclose(blends[1], blends[0], rtol=1e-8)


def test_the_order_of_vertices_and_faces_does_not_matter():
    mesh = MESHES["loose ends"]
    rng = np.random.default_rng(2)
    new_place = rng.permutation(len(mesh.vertices))
    vertices = np.empty_like(mesh.vertices)
    vertices[new_place] = mesh.vertices
    faces = new_place[np.roll(rng.permutation(mesh.faces), 1, axis=1)]
    plain, shuffled = Surface(mesh.vertices, mesh.faces, 0.02), Surface(vertices, faces, 0.02)
    first, second = two_densities(plain)
    there = [np.empty_like(first), np.empty_like(second)]
    for density, source in zip(there, (first, second), strict=True):
        density[new_place] = source
    np.testing.assert_allclose(shuffled.apply(there[0])[new_place], plain.apply(first), rtol=1e-9)
    assert distance(*there, shuffled).value == pytest.approx(distance(first, second, plain).value, rel=1e-8)


@pytest.mark.parametrize("name", ["torus", "sheet", "pieces"])
def test_rigid_motions_and_mirrors_change_nothing(name):
    mesh = MESHES[name]
    turn = np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))[0]
    plain = Surface(mesh.vertices, mesh.faces, 0.02)
    other = moved(mesh, lambda v: v @ turn.T + (3, -20, 7))
    turned = Surface(other.vertices, other.faces, 0.02)
    mirror = moved(mesh, lambda v: v * (1, 1, -1))
    column = columns_on(plain)
    np.testing.assert_allclose(turned.apply(column), plain.apply(column), rtol=1e-6)
    np.testing.assert_allclose(Surface(mirror.vertices, mirror.faces, 0.02).apply(column), plain.apply(column), 1e-6)


def test_far_numerics_reach_further_than_scalings():
    """Three sources on a long strip, with logarithms 1600, 400 and 0: scalings lose the values near the lowest."""
    surface = strip(200, 3e-7)
    x = surface.positions[:, 0]
    logs = np.select([x == 0, x == 100, x == 200], [1600.0, 400.0, 0.0], LOG_NOTHING)
    near, far = np.empty_like(logs), np.empty_like(logs)
    surface.log_apply(logs, near)
    surface.log_apply_far(logs[None], far[None])
    assert (near[x == 200] == LOG_NOTHING).all()
    np.testing.assert_allclose(far[x == 200], 0, atol=1)
    # Each source alone is within reach where it dominates.
    alone = np.stack([np.where(x == source, logs, LOG_NOTHING) for source in (0, 100, 200)])
    surface.log_apply(alone, alone)
    np.testing.assert_allclose(far, np.logaddexp.reduce(alone), atol=1e-9)


def test_where_not_even_the_dense_kernel_reaches():
    """A kernel that does not reach the other end is distinguished from one that is only small there."""
    surface = strip(150, 1e-9)
    x = surface.positions[:, 0]
    first, second = (x < 3).astype(float), (x > 147).astype(float)
    logs = np.where(x < 3, 5000.0, LOG_NOTHING + 0.7)
    out = np.empty_like(logs)
    surface.log_apply_far(logs[None], out[None])
    assert (out[x > 147] == LOG_NOTHING).all()
    with pytest.raises(KernelTooNarrowError, match=r"gamma = 1e-09 is too small .*; try 4e-09"):
        distance(first, second, surface)
    assert np.isfinite(distance(first, second, surface.with_kernel(1e-4)).value)


def test_far_numerics_refuse_large_meshes():
    surface = sphere(5, 1e-6)
    logs = np.zeros((1, *surface.shape))
    with pytest.raises(KernelTooNarrowError, match=r"gamma = 1e-06 is too small .* 10242 vertices; try 2e-06"):
        surface.log_apply_far(logs, logs)
    narrower = surface.with_kernel(1e-12)
    with pytest.raises(KernelTooNarrowError, match="gamma = 1e-12"):
        distance(cap(narrower, 0.0, 0.1), cap(narrower, 3.0, 0.1), narrower)


@pytest.mark.parametrize("gamma", [0, -1, np.nan, np.inf])
def test_gamma_must_be_positive(gamma):
    with pytest.raises(ValueError, match="gamma must be a positive number"):
        Surface(*_triangle(), gamma)
    with pytest.raises(ValueError, match="gamma must be a positive number"):
        sphere(2, 0.1).with_kernel(gamma)


@pytest.mark.parametrize("steps", [0, -3, 2.5])
def test_steps_must_be_whole(steps):
    with pytest.raises(ValueError, match="steps must be a positive whole number"):
        Surface(*_triangle(), 0.1, steps)


def _triangle():
    return np.eye(3), [(0, 1, 2)]


@pytest.mark.parametrize(
    ("vertices", "faces"),
    [
        (np.zeros((0, 3)), np.zeros((0, 3), int)),
        (np.eye(3), np.zeros((0, 3), int)),
        (np.eye(3), [(0, 1, 3)]),
        (np.eye(3), [(0, 1, -1)]),
        (np.eye(3), [(0, 1)]),
        (np.eye(3)[:, :2], [(0, 1, 2)]),
        (np.where(np.eye(3) == 1, np.nan, 0), [(0, 1, 2)]),
        (np.where(np.eye(3) == 1, np.inf, 0), [(0, 1, 2)]),
        (np.ones((3, 3)), [(0, 1, 2)]),
        (np.outer([0, 1, 2], [1, 2, 3]), [(0, 1, 2)]),
        (np.eye(3), [(0, 0, 1), (1, 2, 2)]),
    ],
    ids=["empty", "no faces", "beyond", "negative", "pairs", "flat", "nan", "inf", "point", "line", "twice"],
)
def test_invalid_meshes_are_refused(vertices, faces):
    with pytest.raises(InputError):
        Surface(vertices, faces)


def test_values_at_unused_vertices_are_ignored():
    mesh = MESHES["loose ends"]
    surface = Surface(mesh.vertices, mesh.faces, 0.02)
    plain = two_densities(surface)
    used = surface.weights > 0
    loaded = [np.where(used, density, value) for density, value in zip(plain, (1e9, np.nan), strict=True)]
    assert distance(*loaded, surface).value == distance(*plain, surface).value > 0
    blends = [barycenter(pair, [1, 2], surface).density for pair in (plain, loaded)]
    np.testing.assert_array_equal(blends[1], blends[0])
    assert (blends[0][~used] == 0).all()


@pytest.fixture(scope="module")
def pieces():
    """A ball of 100 vertices, and a torus of 128."""
    mesh = joined(ball(points=100), torus(center=(4, 0, 0), segments=(16, 8)))
    return Surface(mesh.vertices, mesh.faces, 0.01)


def test_components_are_numbered(pieces):
    np.testing.assert_array_equal(pieces.pieces, np.repeat([0, 1], [100, 128]))
    assert sphere(2, 0.1).pieces is None
    loose = Surface([*ball(points=50).vertices, (0, 0, 0)], ball(points=50).faces)
    assert loose.pieces is None


def test_mass_cannot_cross_between_components(pieces):
    """The message says which distribution, how much mass, and where."""
    left, right = (np.where(pieces.pieces == piece, 1.0, 0.0) for piece in (0, 1))
    left, right = (density / (density @ pieces.weights) for density in (left, right))
    with pytest.raises(
        ValueError, match=r"mu\[1\] has mass 0 and mu\[0\] 1 on the piece of 1.. vertices around vertex"
    ):
        distance(left, right, pieces)
    message = (
        r"mus\[2\] has mass 0.25 and mus\[0\] 0.5 on the piece of 100 vertices around vertex 0; mass cannot cross"
        r"|mus\[0\] has mass 0.5 and mus\[2\] 0.75 on the piece of 128 vertices around vertex 100; mass cannot cross"
    )
    with pytest.raises(ValueError, match=message):
        barycenter([left + right, right + left, left + 3 * right], [1, 1, 1], pieces)


def test_equal_masses_on_every_component_are_solved_per_component(pieces):
    """The squared distance is the mass-weighted sum over the components; each has its own barycenter."""
    first, second = columns_on(pieces, 2, seed=9)
    share = 0.3
    for density in (first, second):
        for piece, mass in ((0, share), (1, 1 - share)):
            own = pieces.pieces == piece
            density[own] *= mass / (density * pieces.weights)[own].sum()
    whole = distance(first, second, pieces, tolerance=1e-9)
    blend = barycenter([first, second], [0.4, 0.6], pieces, tolerance=1e-9)
    divergence = 0.0
    for piece, mass in ((0, share), (1, 1 - share)):
        own = pieces.pieces == piece
        index = np.cumsum(own) - 1
        faces = pieces.mesh.faces[own[pieces.mesh.faces].all(axis=1)]
        alone = Surface(pieces.mesh.vertices[own], index[faces], 1.0)
        # The same kernel in the same length unit.
        alone = alone.with_kernel(pieces.gamma * pieces.area / alone.area)
        divergence += mass * distance(first[own], second[own], alone, tolerance=1e-9).divergence
        single = barycenter([first[own], second[own]], [0.4, 0.6], alone, tolerance=1e-9).density
        expected = single * mass / (single @ pieces.weights[own])
        np.testing.assert_allclose(blend.density[own], expected, rtol=1e-6)
    assert whole.divergence == pytest.approx(divergence, rel=1e-6)
    assert (blend.density * pieces.weights)[pieces.pieces == 0].sum() == pytest.approx(share)


def test_distances_between_points_of_components(pieces):
    found = point_distances([3, 200], pieces)
    np.testing.assert_array_equal(np.isfinite(found), [pieces.pieces == 0, pieces.pieces == 1])
