# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A small example of every kind of background work, and ways to interrupt it."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import bpy
import numpy as np

from convwass_addon.bridge.skies.sky_pixels import write_sky
from convwass_addon.bridge.skies.world_skies import sequence_world
from tests.lights import principled, sky
from tests.operators.densities import ball
from tests.operators.running import inventory
from tests.pictures import image_of
from tests.rigs import chain


def two_cubes(folder: Path) -> None:
    for place in (0, 3):
        bpy.ops.mesh.primitive_cube_add(location=(place, 0, 0))
    bpy.ops.object.select_all(action="SELECT")


def two_circles(folder: Path) -> None:
    for place in (0, 3):
        bpy.ops.curve.primitive_bezier_circle_add(location=(place, 0, 0))
        bpy.context.object.data.dimensions = "2D"
    bpy.ops.object.select_all(action="SELECT")


def two_grays(folder: Path) -> None:
    rows, columns = np.mgrid[:24, :24]
    for name, column in (("First", 8), ("Last", 15)):
        pixels = np.ones((24, 24, 4), np.float32)
        pixels[np.hypot(columns - column, rows - 12) < 5, :3] = 0.1
        obj = bpy.data.objects.new(name, None)
        obj.empty_display_type, obj.data = "IMAGE", image_of(name, pixels)
        bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.update()


def painted_ball(folder: Path) -> None:
    ball()


def body_and_rig(folder: Path) -> None:
    bpy.ops.mesh.primitive_uv_sphere_add(segments=12, ring_count=6, radius=3)
    own, body = bpy.context.scene.convwass_armature, bpy.context.object
    own.body, own.rig = body, chain(3, 0.7)
    bpy.ops.convwass.pin_joints(joints="A.head, C.tail")


def two_balls(folder: Path) -> None:
    own = bpy.context.scene.convwass_soft_map
    for name in ("source", "target"):
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2)
        setattr(own, name, bpy.context.object)
    own.pairs.add()


def two_images(folder: Path) -> None:
    for number, name in enumerate(("Red", "Blue")):
        made = image_of(name, np.random.default_rng(number).random((8, 9, 4)))
    bpy.context.scene.convwass_recolor.palette = made


def shot(folder: Path) -> None:
    """A clip of three frames, whose files have their own folder, and a palette."""
    two_images(folder)
    (folder / "in").mkdir(exist_ok=True)
    for number in range(1, 4):
        if (folder / "in" / f"shot.{number:04d}.png").exists():
            continue
        frame = image_of("Frame", np.random.default_rng(9 + number).random((8, 9, 4)))
        frame.filepath_raw, frame.file_format = str(folder / "in" / f"shot.{number:04d}.png"), "PNG"
        frame.save()
        bpy.data.images.remove(frame)
    clip = bpy.data.images.load(str(folder / "in" / "shot.0001.png"))
    clip.name, clip.source = "Shot", "SEQUENCE"


def two_metals(folder: Path) -> None:
    principled("A", 0.4)
    principled("B", 0.7)


def two_skies(folder: Path) -> None:
    (folder / "in").mkdir(exist_ok=True)
    for name, sun in (("Dawn", (1, 0, 1)), ("Noon", (0, 1, 1))):
        if not (folder / "in" / f"{name}.exr").exists():
            write_sky(folder / "in" / f"{name}.exr", sky(sun, rows=16))
        world = sequence_world(name, [folder / "in" / f"{name}.exr"], 1)
        # A single picture, which is read directly.
        world.node_tree.animation_data_clear()
        next(node for node in world.node_tree.nodes if node.type == "TEX_ENVIRONMENT").image.source = "FILE"


_SMALL = {"frames": 2, "resolution": 16, "use_custom_blur": True, "blur": 0.6}

CASES: dict[str, tuple[Callable[[Path], None], dict[str, object]]] = {
    "bake_morph": (two_cubes, {**_SMALL, "motion": "TRANSPORT"}),
    "bake_morph guided": (two_cubes, {**_SMALL, "motion": "GUIDED"}),
    "bake_morph flat": (two_circles, {"frames": 2, "flat_resolution": 64}),
    "bake_morph pictures": (
        two_grays,
        {"inputs": "First,Last", "frames": 2, "flat_resolution": 64, "flat_output": "PICTURE", "folder": "OUT"},
    ),
    "interpolate_density": (painted_ball, {"first": "A", "second": "B", "steps": 2, "max_iterations": 10}),
    "measure_distance": (painted_ball, {"first": "A", "second": "B"}),
    "measure_groups": (painted_ball, {}),
    "fit_armature": (body_and_rig, {"links": 1}),
    "compute_soft_map": (two_balls, {"vertices": 50, "sweeps": 1}),
    "recolor_image": (two_images, {"image": "Red"}),
    "recolor_clip": (shot, {"image": "Shot", "folder": "OUT"}),
    "blend_materials": (two_metals, {"materials": "A, B", "detail": 8, "blends": 2}),
    "blend_skies": (
        two_skies,
        {"worlds": "Dawn, Noon", "folder": "OUT", "frame_start": 1, "frame_end": 3, "width": 64},
    ),
}
"""By name, which begins with that of the operator: a function that makes a scene, given a folder, and arguments."""


def prepare(name: str, folder: Path) -> Callable[[], set[str]]:
    """Make the scene of a case and return a function that does its work; its files go to `out` in the folder."""
    make, arguments = CASES[name]
    make(folder)
    out = str(folder / "out")
    given = {key: out if value == "OUT" else value for key, value in arguments.items()}
    return lambda: call(name, **given)


def call(name: str, **arguments: object) -> set[str]:
    """Call the operator of a case."""
    return getattr(bpy.ops.convwass, name.split()[0])(**arguments)


def kinds_of(kind: type) -> Iterator[type]:
    """Yield all subclasses of a class."""
    for own in kind.__subclasses__():
        yield own
        yield from kinds_of(own)


def traces(folder: Path) -> tuple[object, ...]:
    """Return everything that work could leave behind: data, files, handlers, timers and threads."""
    files = {path: path.read_bytes() if path.is_file() else None for path in folder.rglob("*")}
    handlers = {
        name: list(own) for name in dir(bpy.app.handlers) if isinstance(own := getattr(bpy.app.handlers, name), list)
    }
    threads = {thread for thread in threading.enumerate() if thread.name.startswith("convwass")}
    running = bpy.context.window_manager.convwass_progress.running
    return inventory(), files, handlers, threads, running
