# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Broken input for every application, without Blender: the result is valid, or the input is refused."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from convwass_addon.applications.densities.density_paths import interpolation_steps
from convwass_addon.applications.densities.density_settings import DensitySettings
from convwass_addon.applications.densities.surface_densities import density_surface
from convwass_addon.applications.flat.flat_frames import FlatFrame
from convwass_addon.applications.flat.flat_morph import flat_morph
from convwass_addon.applications.flat.flat_settings import FlatSettings
from convwass_addon.applications.flat.flat_shapes import FlatImage, FlatShape
from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph import morph
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_problem import MorphFrame
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.palettes.palette_settings import RecolorSettings
from convwass_addon.applications.palettes.pixels import PixelFormat
from convwass_addon.applications.palettes.recolor_job import Picture, recolor_steps
from convwass_addon.applications.skeletons.skeleton_fit import fit_steps
from convwass_addon.applications.skeletons.skeleton_graph import JointGraph
from convwass_addon.applications.skeletons.skeleton_settings import SkeletonSettings
from convwass_addon.applications.skies.sky_frames import Skies
from convwass_addon.applications.skies.sky_settings import SkySettings
from convwass_addon.applications.soft_maps.map_sides import MapSide
from convwass_addon.applications.soft_maps.map_solving import soft_map_steps
from convwass_addon.applications.soft_maps.soft_map_settings import SoftMapSettings
from convwass_addon.errors import ConvwassError
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import UNINTERRUPTED, Control, drained, payloads
from tests.flat_shapes import ellipse
from tests.shapes import ball

_BALL = ball(points=80)
_SOLID = MorphSettings(motion="transport", resolution=16, blur=0.8)
_FLAT = FlatSettings(resolution=32, blur=1.0, motion="transport")


def outcome(run: Callable[[], object]) -> str:
    """Run a function; return "refused" or "done"; raise errors of any other kind."""
    try:
        run()
    except ConvwassError as error:
        assert str(error).strip()
        return "refused"
    return "done"


def morph_of(mesh: TriangleMesh, control: Control = UNINTERRUPTED, settings: MorphSettings = _SOLID) -> None:
    """Morph a mesh into a ball."""
    inputs = MorphInputs.of([mesh, _BALL], ["broken", "ball"])
    work = morph(inputs, path_blends(2, 3), settings, control, computation=Computation(1))
    for frame in payloads(work, MorphFrame):
        if frame.mesh is not None:
            _sound(frame.mesh)
            assert frame.origins is None or np.isfinite(frame.origins).all()


def density_of(mesh: TriangleMesh, control: Control = UNINTERRUPTED) -> None:
    """Move mass from the first vertices to the last ones."""
    surface = density_surface(mesh)
    weights = np.zeros((2, len(mesh.vertices)))
    weights[0, : len(mesh.vertices) // 3 + 1] = 1.0
    weights[1, -1:] = 1.0
    settings = DensitySettings(steps=2, max_iterations=40, pieces="match")
    frames = drained(interpolation_steps(*weights, surface, settings, control=control))
    assert np.isfinite(frames.densities).all() and (frames.densities >= 0).all()


def soft_map_of(mesh: TriangleMesh, control: Control = UNINTERRUPTED) -> None:
    """Map a mesh to a ball and back."""
    sides = MapSide(mesh, "broken"), MapSide(_BALL, "ball")
    found = drained(soft_map_steps(*sides, [], SoftMapSettings(vertices=50, sweeps=1), control))
    for points in (found.forward, found.backward):
        assert np.isfinite(points.barycentric).all() and np.isfinite(points.confidence).all()
        assert not np.isnan(points.spread).any()


def skeleton_of(mesh: TriangleMesh, control: Control = UNINTERRUPTED) -> None:
    """Fit a chain of bones into a mesh."""
    middle = mesh.bounds.mean(axis=0) if len(mesh.faces) else np.zeros(3)
    size = np.ptp(mesh.bounds, axis=0) if len(mesh.faces) else np.ones(3)
    ends = middle - 0.2 * size, middle + 0.2 * size
    positions = np.linspace(*ends, 4)
    graph = JointGraph.from_arrays(positions, [(0, 1), (1, 2), (2, 3)], [True, False, False, True])
    found = drained(fit_steps(mesh, graph, SkeletonSettings(outside_pins="move"), control))
    assert np.isfinite(found.positions).all()


def flat_of(rings: list[np.ndarray], control: Control = UNINTERRUPTED) -> None:
    """Morph rings into an ellipse, by mass and by letters, as outlines and as densities."""
    for settings in (
        _FLAT,
        FlatSettings(resolution=32, blur=1.0, motion="transport", words="letters", output="densities"),
    ):
        shapes = [FlatShape(tuple(rings)), FlatShape((ellipse(corners=16),))]
        _flat(shapes, settings, control)


def gray_of(pixels: np.ndarray, control: Control = UNINTERRUPTED) -> None:
    """Morph an image into an ellipse."""
    for kind in ("density", "silhouette"):
        image = FlatImage(pixels[..., 0].T, 0.1, kind=kind)
        _flat([image, FlatShape((ellipse(corners=16),))], _FLAT, control)


def palette_of(pixels: np.ndarray, control: Control = UNINTERRUPTED) -> None:
    """Give an image the colors of another, and vice versa."""
    good = np.random.default_rng(6).random((8, 8, 4)).astype(np.float32)
    for encoding, turn in (("srgb", 1), ("linear", -1)):
        form = PixelFormat(encoding, highest=1.0 if encoding == "srgb" else np.inf)
        source, palette = [Picture(own, form) for own in (pixels.astype(np.float32), good)][::turn]
        found = drained(recolor_steps(source, [palette], [1.0], RecolorSettings(edge_radius=0), control))
        finite = np.isfinite(source.pixels).all(axis=-1)
        assert np.isfinite(found.pixels[finite]).all()


def sky_of(pixels: np.ndarray, control: Control = UNINTERRUPTED) -> None:
    """Blend a sky into another."""
    image = np.asarray(pixels, float)[..., :3]
    image = np.resize(image, (32, 64, 3)) if image.size else image
    good = np.random.default_rng(7).random((32, 64, 3))
    frame = Skies(image, good, SkySettings(rows=32)).frame(0.5)
    control.check()
    assert np.isfinite(frame.image).all() and (frame.image >= 0).all()


ON_MESHES = {"morph": morph_of, "density": density_of, "soft map": soft_map_of, "armature": skeleton_of}
ON_RINGS = {"flat": flat_of}
ON_PIXELS = {"gray": gray_of, "recolor": palette_of, "sky": sky_of}


def _flat(shapes: list[FlatShape | FlatImage], settings: FlatSettings, control: Control) -> None:
    work = flat_morph(shapes, ["broken", "ellipse"], path_blends(2, 2), settings, control, workers=1)
    for frame in payloads(work, FlatFrame):
        if frame.outline is not None:
            assert np.isfinite(frame.outline.points).all()


def _sound(mesh: TriangleMesh) -> None:
    assert np.isfinite(mesh.vertices).all()
    assert not mesh.faces.size or (mesh.faces.min() >= 0 and mesh.faces.max() < len(mesh.vertices))
