# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest

from convwass_addon.applications.morphs.coinciding_solids import CoincidingSolids
from convwass_addon.geometry.level_sets.contours import outline_enclosing
from convwass_addon.geometry.level_sets.even_surface import even_surface
from convwass_addon.geometry.level_sets.isosurface import surface_at_level, surface_enclosing
from convwass_addon.geometry.meshes.normals import vertex_normals
from convwass_addon.geometry.solids.occupancy import occupancy
from tests.shapes import ball

CENTER = np.array([20.3, 19.7, 20.1])


def filled(radius, center=CENTER):
    return occupancy(ball(radius, center, 4000).corners, (40, 40, 40))


@pytest.mark.parametrize("share", [0.2, 0.5])
def test_the_mean_of_concentric_balls_is_the_ball_between(share):
    solids = CoincidingSolids.of([filled(10.0), filled(11.0)], (1.0 - share, share))
    assert solids.disagreement == 0.0
    mesh = surface_at_level(solids.density, 0.5).mesh
    radii = np.linalg.norm(mesh.vertices - CENTER, axis=1)
    assert radii.std() < 0.02
    # A blur shrinks a ball by its variance over the radius.
    assert radii.mean() == pytest.approx(10.0 + share - (0.7**2 + 1.0 / 12.0) / (10.0 + share), abs=0.02)


@pytest.mark.parametrize(("apart", "share"), [(1.0, 0.5), (2.0, 0.5), (3.0, 0.25)])
def test_the_mean_of_concentric_balls_has_no_ripples(apart, share):
    """Normals are off by no more than on a single ball, where meshing alone turns them."""

    def turned(outer, weight):
        radius = 13.0 + weight * (outer - 13.0)
        solids = CoincidingSolids.of([filled(13.0), filled(outer)], (1.0 - weight, weight))
        surface = surface_enclosing(solids.density, 4.0 / 3.0 * np.pi * radius**3)
        mesh = even_surface(surface, solids.density).mesh
        radial = (mesh.vertices - CENTER) / np.linalg.norm(mesh.vertices - CENTER, axis=1)[:, None]
        cosines = (vertex_normals(mesh.vertices, mesh.faces) * radial).sum(axis=1)
        return np.degrees(np.arccos(np.minimum(cosines, 1.0))).mean()

    assert turned(13.0 + apart, share) < 1.25 * turned(13.0, share)


@pytest.mark.parametrize("wanted", [11.0, 12.0, 14.3])
def test_a_ball_that_is_offset_to_a_volume_stays_round(wanted):
    """Two balls of radius 13 have a mean of any volume."""
    solids = CoincidingSolids.of([filled(13.0)] * 2, (0.5, 0.5), 4.0 / 3.0 * np.pi * wanted**3)
    radii = np.linalg.norm(surface_at_level(solids.density, 0.5).mesh.vertices - CENTER, axis=1)
    assert radii.mean() == pytest.approx(wanted, abs=0.15)
    assert radii.std() < 0.03


def test_the_mean_of_concentric_disks_is_round_however_far_they_are_apart():
    center, area = np.array([160.3, 159.6]), np.pi * 95.0**2
    cells = np.stack(np.meshgrid(*[np.arange(320) + 0.5] * 2, indexing="ij"), axis=-1) - center
    disks = [np.clip(radius + 0.5 - np.linalg.norm(cells, axis=-1), 0.0, 1.0) for radius in (60.0, 130.0)]
    (ring,) = outline_enclosing(CoincidingSolids.of(disks, (0.5, 0.5), area).density, area).outline.rings
    radii = np.linalg.norm(ring - center, axis=1)
    assert radii.mean() == pytest.approx(95.0, abs=0.05)
    assert radii.std() < 0.05


def test_the_mean_of_concentric_balls_is_round_on_a_fine_grid():
    center = np.array([80.3, 79.7, 80.1])
    cells = np.stack(np.meshgrid(*[np.arange(160) + 0.5] * 3, indexing="ij"), axis=-1)
    away = np.linalg.norm(cells - center, axis=-1)
    balls = [np.clip(radius + 0.5 - away, 0.0, 1.0) for radius in (30.0, 70.0)]
    inside = CoincidingSolids.of(balls, (0.5, 0.5), 4.0 / 3.0 * np.pi * 50.0**3).density > 0.5
    assert away[inside].max() < 50.1
    assert away[~inside].min() > 49.9


def rod(radius, x, top=34):
    """An upright rod through the grid, up to a height."""
    cells = np.stack(np.meshgrid(*[np.arange(40) + 0.5] * 3, indexing="ij"), axis=-1)
    across = np.linalg.norm(cells[..., :2] - (x, 20.5), axis=-1)
    return np.clip(radius - across + 0.5, 0.0, 1.0) * (cells[..., 2] < top) * (cells[..., 2] > 5)


def slab(height):
    heights = np.arange(40) + 0.5
    return np.broadcast_to(np.clip(height - heights + 0.5, 0.0, 1.0) * (heights > 3), (40, 40, 40))


def test_thin_parts_that_have_moved_disagree():
    solids = CoincidingSolids.of([rod(2.0, 17.5), rod(2.0, 22.5)], (0.5, 0.5))
    assert solids.disagreement > 0.5


@pytest.mark.parametrize("share", [0.4, 0.6])
def test_a_rod_that_only_one_solid_has_grows_out_of_the_other(share):
    plain = slab(12.0)
    solids = CoincidingSolids.of([plain, np.maximum(plain, rod(3.5, 20.5))], (1.0 - share, share))
    assert solids.disagreement == 0.0
    line = solids.density[20, 20]
    top = np.flatnonzero(line > 0.5)[-1] + 0.5
    # 22 cells long, and its front ends three cells beyond it.
    assert top == pytest.approx(12.0 + 25.0 * share, abs=1.0)
    assert (line[6 : int(top)] > 0.5).all()


@pytest.mark.parametrize("share", [0.4, 0.6])
def test_a_rod_that_is_a_third_of_the_surface_grows_out_of_a_ball(share):
    """So much is not taken for a small rest, but its mean is known."""
    base = filled(6.5, np.array([20.5, 20.5, 11.0]))
    solids = CoincidingSolids.of([base, np.maximum(base, rod(3.5, 20.5))], (1.0 - share, share))
    assert solids.disagreement == 0.0
    top = np.flatnonzero(solids.density[20, 20] > 0.5)[-1] + 0.5
    assert top == pytest.approx(17.5 + (34.0 + 3.0 - 17.5) * share, abs=2.0)


@pytest.mark.parametrize(
    ("radius", "top", "least"), [(9.0, 16, (1.0, 1.0)), (4.5, 24, (0.2, 0.8)), (4.5, 34, (0.0, 0.01))]
)
def test_a_small_rest_is_taken_to_agree_and_a_middle_one_in_part(radius, top, least):
    """A rod moves beside a ball: about 3, 19 and 27 % of the surface."""
    here = filled(radius, np.array([20.0, 28.0, 20.0]))
    solids = CoincidingSolids.of([np.maximum(here, rod(2.0, x, top)) for x in (3.5, 8.5)], (0.5, 0.5))
    assert solids.agreement.shape == here.shape
    assert least[0] <= solids.agreement.min() <= least[1]
    assert solids.coincide == (least == (1.0, 1.0))


def test_the_mixture_is_the_mean_where_solids_agree_and_the_other_density_elsewhere():
    """Balls far away from rods, one of which has moved."""
    here = filled(4.5, np.array([20.0, 32.0, 12.0]))
    solids = CoincidingSolids.of([np.maximum(here, rod(2.0, x)) for x in (17.5, 22.5)], (0.5, 0.5))
    other = np.full(here.shape, 0.25, np.float32)
    mixed = solids.mixed(other, (slice(None),) * 3)
    common, moved = (20, 35, 12), (19, 20, 20)
    assert mixed[common] == pytest.approx(solids.density[common], abs=1e-3)
    assert mixed[moved] == pytest.approx(0.25, abs=0.02)
