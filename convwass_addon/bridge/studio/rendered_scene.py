# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A temporary scene for rendering pictures: floor, lights, camera, renderer."""

from __future__ import annotations

import math
import shutil
import tempfile
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType

import bpy
import numpy as np
from mathutils import Matrix

from ...disk_space import require_whole
from ...drafts import new_draft
from ...errors import Cancelled, ConvwassError, InputError
from ...geometry.algebra.affine import transformed_points
from ..color_spaces import show_unchanged
from ..element_values import element_values
from ..files.output_paths import checked_target
from ..interrupts import delayed_interrupts
from ..objects import stand
from .framing import Pose, View
from .studio_set import even_sky, floor_material, floor_mesh

FLOOR_REACH = 60.0
"""Edge of the floor in radii of the shapes on it, large enough to fill the view of every camera."""

LENS = 0.24
"""Tangent of half the horizontal field of view: a portrait lens."""

PATHS_FOR_DENOISER = 6
"""Factor for the number of samples if there is no denoiser."""

MARGIN = 0.10
"""Margin at each edge, relative to half the width or height of the picture."""


# Blender's name for the image of the last render.
_RESULT = "Render Result"


class Studio:
    """A temporary scene to render in, used as a context manager; the user's scenes are not changed.

    All lights are infinitely far away, so that every shape is lit in the same way, wherever it is.

    Raises
    ------
    ConvwassError
        On entering: the Cycles render engine is disabled.
    """

    def __enter__(self) -> Studio:
        self._made: list[bpy.types.ID] = []
        self.scene = self._keep(bpy.data.scenes.new("Convwass Studio"))
        try:
            _set_renderer(self.scene)
            self._camera = self._add("Studio Camera", self._keep(bpy.data.cameras.new("Studio Camera")))
            self.scene.camera = self._camera
            self.scene.world = self._keep(even_sky())
        except BaseException:
            self._clear()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._clear()

    def show(self, obj: bpy.types.Object, shift: Sequence[float] = (0.0, 0.0, 0.0)) -> bpy.types.Object:
        """Add a copy of an object, without its animation and moved by `shift` (3,) in world space.

        Returns
        -------
        bpy.types.Object
            The copy, visible in renders; it shares the object's data and is removed with the studio.
        """
        copy = self._keep(obj.copy())
        copy.animation_data_clear()
        self._made += stand(copy, Matrix.Translation(shift) @ world_matrix(obj))
        copy.hide_render = copy.hide_viewport = False
        self.scene.collection.objects.link(copy)
        return copy

    def build(self, points: Sequence[np.ndarray], view: View) -> float:
        """Place the floor below all shapes, and the lights for a camera that looks from `view`.

        Parameters
        ----------
        points : sequence of (n, 3) arrays
            Points of the shapes, world space.
        view : View
            The lights are to the left of the camera and behind the shapes.

        Returns
        -------
        float
            Extent of the scene, including the floor.
        """
        low, high = (pick([pick(shape, axis=0) for shape in points], axis=0) for pick in (np.min, np.max))
        middle = np.array([*(low + high)[:2] / 2.0, low[2]])
        radius = float(np.linalg.norm(high - low))
        mesh = self._keep(floor_mesh(radius * FLOOR_REACH))
        mesh.materials.append(self._keep(floor_material()))
        self._add("Studio Floor", mesh).location = middle
        for name, strength, width, color, turn, elevation in (
            ("Studio Key", 2.45, 24.0, (1.0, 0.97, 0.94), -50.0, 50.0),
            ("Studio Rim", 0.40, 16.0, (0.88, 0.94, 1.0), 148.0, 34.0),
        ):
            lamp = self._keep(bpy.data.lights.new(name, "SUN"))
            lamp.energy, lamp.angle, lamp.color = strength, math.radians(width), color
            direction = View(view.azimuth + math.radians(turn), math.radians(elevation))
            self._add(name, lamp).matrix_world = pose_matrix(Pose(middle, direction))
        return 3.0 * radius * FLOOR_REACH

    def look_flat(self, pose: Pose, width: float, depth: float) -> None:
        """Set up an orthographic camera with a picture `width` wide, and a clipping distance of `depth`."""
        camera = self._camera.data
        camera.type = "ORTHO"
        camera.sensor_fit = "HORIZONTAL"
        camera.ortho_scale = width
        camera.clip_start, camera.clip_end = depth * 1e-3, depth
        self._camera.matrix_world = pose_matrix(pose)

    def look(self, pose: Pose, depth: float) -> None:
        """Set up a perspective camera, with a clipping distance of `depth`."""
        camera = self._camera.data
        camera.sensor_fit = "HORIZONTAL"
        camera.angle = 2.0 * math.atan(LENS)
        camera.clip_start, camera.clip_end = depth * 1e-4, depth
        self._camera.matrix_world = pose_matrix(pose)

    def set_quality(self, resolution: tuple[int, int], samples: int) -> None:
        """Set the size of the picture in pixels and the number of samples, which is raised without a denoiser."""
        self.scene.render.resolution_x, self.scene.render.resolution_y = resolution
        self.scene.cycles.samples = samples * (1 if self.scene.cycles.use_denoising else PATHS_FOR_DENOISER)

    def render(self, path: Path) -> None:
        """Render a picture to a PNG file in an existing folder.

        Raises
        ------
        ConvwassError
            Blender did not write the picture.
        """
        # Blender would expand "#" and "{}" in the user's path, so it writes to a temporary path.
        with tempfile.TemporaryDirectory(prefix="convwass-") as folder:
            picture = Path(folder) / "picture.png"
            self.scene.render.filepath = str(picture)
            run_render(self.scene, write_still=True)
            move_result(picture, path)

    def _keep(self, block: bpy.types.ID) -> bpy.types.ID:
        """Register a data-block for removal."""
        self._made.append(block)
        return block

    def _add(self, name: str, data: bpy.types.ID) -> bpy.types.Object:
        obj = self._keep(bpy.data.objects.new(name, data))
        self.scene.collection.objects.link(obj)
        return obj

    def _clear(self) -> None:
        bpy.data.batch_remove(self._made)


def checked_output(path: str | Path, suffix: str) -> Path:
    """Return the absolute path of a file to be written.

    Raises
    ------
    InputError
        As `checked_target`, or the extension is not `suffix`.
    """
    target = checked_target(Path(path))
    if target.suffix.lower() != suffix:
        raise InputError(
            "{name} cannot be written: choose a file name that ends with {suffix}.", name=target.name, suffix=suffix
        )
    return target


def choose_cycles(scene: bpy.types.Scene) -> None:
    """Select Cycles for a scene; raises ConvwassError if it is disabled."""
    try:
        scene.render.engine = "CYCLES"
    except TypeError as error:
        raise ConvwassError(
            "Pictures need the Cycles render engine; switch it on under Edit > Preferences > Add-ons."
        ) from error


def run_render(scene: bpy.types.Scene, **options: bool) -> None:
    """Render a scene; converts Blender's errors to `ConvwassError`.

    Blender has one image for render results, which shows this render afterwards, or is removed if there was none
    before.

    A rendering cannot be stopped by signals in Python, so they take effect after it.

    Raises
    ------
    Cancelled
        The user stopped the render in its window, or Blender, which handles Ctrl+C itself, did.
    """
    stopped: list[bool] = []

    def note(*_: object) -> None:
        stopped.append(True)

    had_result = _RESULT in bpy.data.images
    bpy.app.handlers.render_cancel.append(note)
    try:
        with delayed_interrupts():
            bpy.ops.render.render(scene=scene.name, **options)
    except RuntimeError as error:
        raise ConvwassError("Blender could not render the picture: {reason}", reason=str(error)) from error
    finally:
        bpy.app.handlers.render_cancel.remove(note)
        if not had_result and _RESULT in bpy.data.images:
            bpy.data.images.remove(bpy.data.images[_RESULT])
    if stopped:
        raise Cancelled("The rendering was stopped.")


def move_result(source: Path, target: Path) -> None:
    """Move a finished file to its target.

    Raises
    ------
    ConvwassError
        Blender has not written the file, or the target is not writable.
    """
    if not source.is_file():
        raise ConvwassError(
            "Blender's renderer did not write {name}; its messages in the console say why.", name=target.name
        )
    require_whole(source, target)
    # From another disk it is copied, which may fail halfway.
    draft = new_draft(target)
    try:
        shutil.move(source, draft)
        draft.replace(target)
    except OSError as error:
        raise ConvwassError(
            "{target} cannot be written ({reason}); close programs that show it, or choose another folder.",
            target=str(target),
            reason=error.strerror,
        ) from error
    finally:
        draft.unlink(missing_ok=True)


def world_points(obj: bpy.types.Object) -> np.ndarray:
    """Return the vertices of a mesh object in world space, (n, 3), even if it is hidden."""
    points = element_values(obj.data.vertices, "co", 3)
    return transformed_points(points, world_matrix(obj))


def world_matrix(obj: bpy.types.Object) -> Matrix:
    """Return the world matrix of an object; `matrix_world` is out of date for hidden objects."""
    if obj.parent is None:
        return obj.matrix_basis.copy()
    return world_matrix(obj.parent) @ obj.matrix_parent_inverse @ obj.matrix_basis


def opening(resolution: tuple[int, int]) -> tuple[float, float]:
    """Return the tangents of half the angle that shapes may fill, horizontally and vertically, for a picture size."""
    width, height = resolution
    return LENS * (1.0 - MARGIN), LENS * (1.0 - MARGIN) * height / width


def pose_matrix(pose: Pose) -> Matrix:
    """Return the world matrix of a camera or lamp."""
    matrix = np.eye(4)
    matrix[:3, :3] = pose.view.axes.T
    matrix[:3, 3] = pose.position
    return Matrix(matrix)


def _set_renderer(scene: bpy.types.Scene) -> None:
    """Select Cycles on the CPU, few light bounces, and unmodified colors."""
    choose_cycles(scene)
    cycles, render = scene.cycles, scene.render
    cycles.device = "CPU"
    cycles.use_adaptive_sampling = False
    cycles.max_bounces = cycles.diffuse_bounces = 3
    cycles.glossy_bounces = 2
    cycles.caustics_reflective = cycles.caustics_refractive = False
    _set_denoiser(cycles)
    render.use_persistent_data = True
    render.resolution_percentage = 100
    render.image_settings.file_format = "PNG"
    render.image_settings.color_mode = "RGB"
    show_unchanged(scene)
    scene.view_settings.exposure = 0.0


def _set_denoiser(cycles: bpy.types.PropertyGroup) -> None:
    """Enable the denoiser, if this Blender has one."""
    try:
        cycles.denoiser = "OPENIMAGEDENOISE"
    except TypeError:
        cycles.use_denoising = False
        return
    cycles.use_denoising = True
    cycles.denoising_prefilter = "FAST"
    cycles.denoising_quality = "BALANCED"
