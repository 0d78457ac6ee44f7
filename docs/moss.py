# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw moss that spreads over a horse, docs/pictures/moss.jpg: ``python3 run.py python docs/moss.py``."""

from __future__ import annotations

import math
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
from photographs import PROJECT, photograph_row

from convwass_addon.bridge.studio.framing import View
from convwass_addon.bridge.studio.rendered_scene import Studio
from convwass_addon.cli.demo_moss import save_moss

_FRAMES = (1, 40, 75, 110)
_STEP = 2.35
_SIZE = (1600, 400)


def main() -> None:
    """Create the demo's file, and render some of its frames in a row."""
    view = View(-math.pi / 2 + math.radians(24.0), math.radians(12.0))
    with TemporaryDirectory() as folder:
        save_moss(PROJECT / "assets" / "shapes" / "horse.ply", Path(folder) / "moss.blend")
        scene = bpy.context.scene
        (obj,) = (obj for obj in scene.objects if obj.type == "MESH")
        with Studio() as studio:
            shown = []
            for column, frame in enumerate(_FRAMES):
                scene.frame_set(frame)
                shown.append(studio.show(obj, tuple(_STEP * column * view.axes[0])))
            photograph_row(studio, shown, view, _STEP, _SIZE, "moss")


if __name__ == "__main__":
    main()
