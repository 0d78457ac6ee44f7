# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw the picture of moss that creeps over a horse, docs/pictures/moss.jpg: ``PYTHONPATH=. python docs/moss.py``."""

from __future__ import annotations

import math
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
import numpy as np

from convwass_addon.bridge.framing import Pose, View
from convwass_addon.bridge.studio import Studio, world_points
from convwass_addon.cli.demo_moss import save_moss

PROJECT = Path(__file__).resolve().parents[1]
_FRAMES = (1, 40, 75, 110)
_STEP = 2.35
_SIZE = (1600, 400)


def main() -> None:
    """Make the demo's file, and render some of its frames side by side."""
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
            points = np.concatenate([world_points(one) for one in shown])
            studio.build([world_points(one) for one in shown], view)
            middle = (points.min(axis=0) + points.max(axis=0)) / 2.0
            studio.look_flat(Pose(middle + 50.0 * view.axes[2], view), _STEP * len(shown), 200.0)
            studio.set_quality(_SIZE, 24)
            studio.render(Path(folder) / "moss.png")
            picture = bpy.data.images.load(str(Path(folder) / "moss.png"))
            # Reading the file sets the format again, and it is read only when it is looked at.
            picture.update()
            picture.file_format = "JPEG"
            picture.save(filepath=str(PROJECT / "docs" / "pictures" / "moss.jpg"), quality=88)


if __name__ == "__main__":
    main()
