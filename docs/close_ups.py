# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw close-ups of blends into docs/pictures: ``python3 run.py python docs/close_ups.py``.

``close_up_face.jpg`` shows the head of a man who becomes an ogre, next to both shapes and between them;
``close_up_slow_motion.jpg`` shows ten moments of a ball that opens to become a knot. ``--only NAME`` draws one.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
import numpy as np
from clay import clay, frame_object
from PIL import Image, ImageDraw, ImageFont

from convwass_addon.applications.morphs.layouts import Blend
from convwass_addon.applications.morphs.morph import morph
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.bridge.studio.framing import Pose, View
from convwass_addon.bridge.studio.rendered_scene import Studio
from convwass_addon.geometry.meshes.mesh import TriangleMesh

# Unlike the add-on, the benchmarks are not installed.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from benchmarks.coherence_pairs import pairs_named

PICTURES = Path(__file__).resolve().parent / "pictures"

# Light paths per pixel, quality of JPEG, height of labels in pixels.
_SAMPLES, _QUALITY, _LABEL = 16, 86, 26
_INK = (52, 52, 56)
_CLAY = (0.48, 0.12, 0.05, 1.0)


@dataclass(frozen=True)
class Part:
    """What a tile shows of a frame.

    Attributes
    ----------
    middle : (3,) float64
        Point in the middle of the tile.
    width : float
        Of the tile, in scene units.
    """

    middle: np.ndarray
    width: float


def main() -> None:
    """Draw all pictures or one."""
    pictures = {"close_up_face": face, "close_up_slow_motion": slow_motion}
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", choices=pictures, help="draw this picture alone")
    options = parser.parse_args()
    for name in [options.only] if options.only else pictures:
        path = PICTURES / f"{name}.jpg"
        pictures[name]().save(path, quality=_QUALITY, optimize=True, progressive=True)
        print(f"{path.name}: {path.stat().st_size / 1e3:.0f} kB")


def face() -> Image.Image:
    """Show the head of a man who becomes an ogre."""
    (pair,) = pairs_named(["man to ogre"], None)
    ends = pair.ends()
    labels = ("0", "1/24", "1/4", "1/2", "3/4", "23/24", "1")
    frames = blended((ends.first, ends.second), [0.0, 1 / 24, 0.25, 0.5, 0.75, 23 / 24, 1.0], cells=100)
    return tiled(frames, labels, _head, View(-math.pi / 2 + 0.5, math.radians(4.0)), size=300, columns=4)


def slow_motion() -> Image.Image:
    """Show how a ball opens on its way to a knot."""
    (pair,) = pairs_named(["ball to knot"], None)
    ends = pair.ends()
    times = np.linspace(3.0, 9.3, 10) / 24.0
    labels = [f"frame {24.0 * t:.1f}" for t in times]
    frames = blended((ends.first, ends.second), times, cells=100)
    return tiled(frames, labels, _whole, View(-math.pi / 2 + 0.44, math.radians(8.0)), size=300, columns=5)


def blended(shapes: Sequence[TriangleMesh], times: Sequence[float], cells: int) -> list[TriangleMesh]:
    """Return the blends of two shapes at some times from 0 to 1, with default settings."""
    blends = [Blend((1.0 - float(t), float(t))) for t in times]
    steps = morph(MorphInputs.of(shapes, ("First", "Second")), blends, MorphSettings(resolution=cells))
    frames = [step.payload for step in steps if step.payload is not None]
    return [shapes[frame.blend.source] if frame.mesh is None else frame.mesh for frame in frames]


def _head(mesh: TriangleMesh) -> Part:
    low, high = mesh.bounds[:, 2]
    height = 0.2 * (high - low)
    top = mesh.vertices[mesh.vertices[:, 2] > high - height]
    return Part(np.array([*top.mean(axis=0)[:2], high - 0.55 * height]), 1.25 * height)


def _whole(mesh: TriangleMesh) -> Part:
    return Part(mesh.bounds.mean(axis=0), 1.05 * mesh.longest_side)


def tiled(
    frames: Sequence[TriangleMesh],
    labels: Sequence[str],
    part_of: Callable[[TriangleMesh], Part],
    view: View,
    size: int,
    columns: int,
) -> Image.Image:
    """Render a part of every frame, and arrange the tiles in rows with labels below."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    material = clay(_CLAY)
    parts = [part_of(frame) for frame in frames]
    width = max(part.width for part in parts)
    rows = -(-len(frames) // columns)
    sheet = Image.new("RGB", (size * columns, (size + _LABEL) * rows), "white")
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(16)
    for index, (frame, part, label) in enumerate(zip(frames, parts, labels, strict=True)):
        left, top = size * (index % columns), (size + _LABEL) * (index // columns)
        with Studio() as studio, TemporaryDirectory() as folder:
            studio.show(frame_object(frame, material))
            depth = studio.build([frame.vertices], view)
            away = frame.longest_side
            studio.look_flat(Pose(part.middle + 3.0 * away * view.axes[2], view), width, depth)
            studio.set_quality((size, size), _SAMPLES)
            studio.render(Path(folder) / "tile.png")
            with Image.open(Path(folder) / "tile.png") as tile:
                sheet.paste(tile.convert("RGB"), (left, top))
        draw.text((left + size / 2, top + size + _LABEL / 2), label, _INK, font, anchor="mm")
        print(".", end="", flush=True)
    print()
    return sheet


if __name__ == "__main__":
    main()
