# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from dataclasses import dataclass, replace

import numpy as np
import pytest

from convwass_addon.applications.morphs.layouts import Blend, path_blends
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.morphs.moving_problem import MovingProblem
from convwass_addon.applications.morphs.part_labels import unparted
from convwass_addon.applications.morphs.preparing import prepared_problem
from convwass_addon.applications.motions.motion import MovedShape
from convwass_addon.geometry.meshes.closest_points import ClosestPointFinder
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import Control, drained
from tests.shapes import ball, box, turned

ANGLE = np.pi / 2
MIDDLE = Blend((0.5, 0.5))
RADII = (1.0, np.cbrt(3.0))
NAMES = ("lying", "standing")


ROD = box((2.0, 0.3, 0.3), center=(1.0, 0.0, 0.0))
SHAPES = (ROD, turned(ROD, ANGLE))


@dataclass(frozen=True)
class Turning:
    """Both rods turn about the hinge, exactly."""

    def moved(self, weights):
        share = weights[1]
        turns = (share * ANGLE, (share - 1.0) * ANGLE)
        return [
            MovedShape(shape, turned(shape, turn).vertices) if weight > 0 else None
            for shape, turn, weight in zip(SHAPES, turns, weights, strict=True)
        ]


@pytest.fixture(scope="module")
def problem() -> MovingProblem:
    settings = MorphSettings(resolution=48, on_floor=False)
    still = drained(prepared_problem(MorphInputs.of(SHAPES, NAMES), settings, 1))
    return MovingProblem.of(still, Turning(), path_blends(2, 4), NAMES, unparted(2), Control())


@pytest.mark.parametrize("share", [0.25, 0.5])
def test_a_turning_rod_stays_a_rod(problem, share):
    frame = problem.frame(Blend((1.0 - share, share)), Control())
    expected = turned(ROD, share * ANGLE)
    assert frame.mesh.volume == pytest.approx(ROD.volume, rel=5e-3)
    away = ClosestPointFinder(expected.corners).find(frame.mesh.vertices).distances
    assert away.mean() < 0.15 * problem.lattice.spacing
    reach = np.linalg.norm(frame.mesh.vertices[:, :2], axis=1).max()
    assert reach == pytest.approx(2.0, abs=problem.lattice.spacing)


def test_the_first_blend_has_the_edges_of_the_box(problem):
    """Read at 48 cells, the rod loses a tenth of its area, and its edges are half a cell away."""
    share = 1 / 24
    frame = problem.frame(Blend((1.0 - share, share)), Control())
    expected = turned(ROD, share * ANGLE)
    assert frame.mesh.area == pytest.approx(expected.area, rel=0.01)
    ends = np.array([(y, z) for y in (-0.15, 0.15) for z in (-0.15, 0.15)])
    along = np.stack(np.broadcast_arrays(np.linspace(0.1, 1.9, 50)[:, None], *ends.T), axis=-1).reshape(-1, 3)
    edges = turned(TriangleMesh(along, ROD.faces), share * ANGLE).vertices
    away = ClosestPointFinder(frame.mesh.corners).find(edges).distances / problem.lattice.spacing
    assert np.quantile(away, 0.9) < 0.1
    without = replace(problem.still.settings, detail=0.0)
    plain = replace(problem, still=replace(problem.still, transport=replace(problem.still.transport, settings=without)))
    plain = plain.frame(Blend((1.0 - share, share)), Control()).mesh
    assert plain.area < 0.95 * expected.area
    assert len(plain.faces) < len(frame.mesh.faces) < 2 * len(plain.faces)


def test_origins_lie_on_the_inputs_and_belong_together(problem):
    frame = problem.frame(MIDDLE, Control())
    for shape, own in zip(SHAPES, frame.origins, strict=True):
        assert ClosestPointFinder(shape.corners).find(own).distances.max() < 1e-5
    back = turned(TriangleMesh(frame.origins[1].astype(float), frame.mesh.faces), -ANGLE).vertices
    apart = np.linalg.norm(back - frame.origins[0], axis=1)
    assert np.quantile(apart, 0.95) < problem.lattice.spacing


def test_velocity_is_that_of_the_turn(problem):
    """With weights that change at the rate r, a point at p moves with r ANGLE z x p."""
    frame = problem.frame(MIDDLE, Control())
    rate = 0.1
    velocity = -rate * frame.tangents[0].astype(float) + rate * frame.tangents[1]
    x, y, _ = frame.mesh.vertices.T
    expected = rate * ANGLE * np.stack([-y, x, np.zeros_like(x)], axis=1)
    assert np.abs(velocity - expected).mean() < 0.02 * rate * ANGLE


def test_the_grid_holds_the_swinging_rod(problem):
    """At half of the way the rod reaches further along no axis than before, but a rod that swings through does."""
    settings = MorphSettings(resolution=48, on_floor=False)
    opposite = (ROD, turned(ROD, np.pi))

    @dataclass(frozen=True)
    class HalfCircle(Turning):
        def moved(self, weights):
            turns = (weights[1] * np.pi, (weights[1] - 1.0) * np.pi)
            return [
                MovedShape(shape, turned(shape, turn).vertices) for shape, turn in zip(opposite, turns, strict=True)
            ]

    still = drained(prepared_problem(MorphInputs.of(opposite, NAMES), settings, 1))
    moving = MovingProblem.of(still, HalfCircle(), path_blends(2, 4), NAMES, unparted(2), Control())
    assert moving.lattice.spacing == still.lattice.spacing
    assert moving.lattice.shape[1] > still.lattice.shape[1] + 20
    frame = moving.frame(MIDDLE, Control())
    assert frame.mesh.volume == pytest.approx(ROD.volume, rel=5e-3)
    assert frame.mesh.bounds[1, 1] == pytest.approx(2.0, abs=still.lattice.spacing)
    # A blend between the sampled ones gets the cells that it needs.
    moving = MovingProblem.of(still, HalfCircle(), [Blend((0.95, 0.05))], NAMES, unparted(2), Control())
    assert moving.lattice.shape[1] < frame.record["cells"][1]
    again = moving.frame(MIDDLE, Control())
    np.testing.assert_allclose(again.mesh.bounds, frame.mesh.bounds, atol=0.02 * still.lattice.spacing)


def test_an_input_is_shown_unchanged(problem):
    assert problem.frame(Blend((1.0, 0.0)), Control()).mesh is None


def test_inputs_of_different_size_fill_their_cells():
    """Two similar balls, of which one has three times the volume, coincide at every moment."""
    balls = tuple(ball(radius) for radius in RADII)

    @dataclass(frozen=True)
    class Scaling(Turning):
        def moved(self, weights):
            radius = np.dot(weights, RADII)
            return [MovedShape(own, own.vertices * (radius / size)) for own, size in zip(balls, RADII, strict=True)]

    still = drained(prepared_problem(MorphInputs.of(balls, NAMES), MorphSettings(resolution=48), 1))
    problem = MovingProblem.of(still, Scaling(), path_blends(2, 4), NAMES, unparted(2), Control())
    moved = problem.moved_blend(MIDDLE, Control())
    assert moved.coincides
    assert [own.max() for own in moved.occupancies] == pytest.approx([1.0, 1.0])
    volume = 0.5 * sum(abs(own.volume) for own in balls)
    assert moved.volume * still.lattice.spacing**3 == pytest.approx(volume, rel=1e-3)
    # Both surfaces are where the ball of the mean volume has its surface.
    axis = moved.solids.depths[:, :, moved.solids.depths.shape[2] // 2, moved.solids.depths.shape[3] // 2]
    assert np.abs(axis[0] - axis[1]).max() < 0.05
    inside = (axis[0] > 0.0).sum() * still.lattice.spacing
    assert inside == pytest.approx(2.0 * np.cbrt(0.75 * volume / np.pi), abs=1.5 * still.lattice.spacing)


def test_a_blend_has_only_the_cells_that_it_needs():
    """A rod that turns within a plane needs few cells beside that plane."""
    settings = MorphSettings(resolution=48, on_floor=False)
    still = drained(prepared_problem(MorphInputs.of(SHAPES, NAMES), settings, 1))
    apart = np.array([8.0, 0.0, 16.0])
    large = replace(still.lattice, shape=(64, 56, 48), origin=still.lattice.origin - apart * still.lattice.spacing)
    problem = replace(MovingProblem.of(still, Turning(), [MIDDLE], NAMES, unparted(2), Control()), lattice=large)
    moved = problem.moved_blend(MIDDLE, Control()).problem.lattice
    # The longest side stays: lengths that are relative to it are the same in all blends.
    assert moved.shape[0] == 64
    assert moved.shape[2] <= 24
    first = (moved.origin - large.origin) / large.spacing
    np.testing.assert_allclose(first, np.round(first / 8.0) * 8.0, atol=1e-9)


def test_sampled_blends_are_not_moved_again(problem):
    class Moved(Exception):
        pass

    class Unmovable:
        def moved(self, weights):
            raise Moved

    again = replace(problem, motion=Unmovable())
    found = again.moved_blend(MIDDLE, Control())
    expected = replace(problem, sampled=None).moved_blend(MIDDLE, Control())
    for own, other in zip(found.shapes, expected.shapes, strict=True):
        np.testing.assert_array_equal(own.vertices, other.vertices)
    with pytest.raises(Moved):
        again.moved_blend(Blend((0.6, 0.4)), Control())
