# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw docs/pictures/skies.jpg, skies between two others: ``python3 run.py python docs/skies.py``.

Blender's sky texture with the sun 12 degrees high, and 50 degrees high a quarter of the way around; from the top to
the bottom t = 0, 1/4, 1/2, 3/4 and 1. At the left the two pictures are mixed, at the right the sun and its glow move.
Each picture is the upper half of the panorama and a little of the ground.
"""

from __future__ import annotations

import math
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from convwass_addon.applications.skies.sky_frames import Skies
from convwass_addon.bridge.nodes.node_trees import own_tree
from convwass_addon.bridge.skies.sky_pixels import turned
from convwass_addon.bridge.skies.world_skies import world_sky

PICTURE = Path(__file__).resolve().parent / "pictures" / "skies.jpg"
_HEIGHT, _GROUND, _GAP = 384, 24, 10
# Elevation and azimuth of the sun, in degrees.
_SUNS = ((12.0, 20.0), (50.0, 113.0))
_EXPOSURE = 0.11


def main() -> None:
    """Draw the picture."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    ends = [world_sky(_world(*place), _HEIGHT) for place in _SUNS]
    skies = Skies(*ends)
    rows = []
    for time in np.linspace(0.0, 1.0, 5):
        frame = skies.frame(float(time))
        for lamp in frame.lamps:
            print(f"t = {time:.2f}: sun at {lamp.direction.round(3)}, flux {lamp.flux.round(2)}")
        pair = [_seen((1.0 - time) * ends[0] + time * ends[1]), _seen(frame.image)]
        rows.append(_framed(np.concatenate([pair[0], np.ones((len(pair[0]), _GAP, 3)), pair[1]], axis=1)))
    picture = np.concatenate(rows)[:-_GAP]
    Image.fromarray((255 * picture + 0.5).astype(np.uint8)).save(PICTURE, quality=92)


def _world(elevation: float, rotation: float) -> bpy.types.World:
    world = bpy.data.worlds.new("Sky")
    tree = own_tree(world)
    texture = tree.nodes.new("ShaderNodeTexSky")
    kinds = texture.bl_rna.properties["sky_type"].enum_items.keys()
    texture.sky_type = "MULTIPLE_SCATTERING" if "MULTIPLE_SCATTERING" in kinds else "NISHITA"
    texture.sun_elevation, texture.sun_rotation = math.radians(elevation), math.radians(rotation)
    background = next(node for node in tree.nodes if node.type == "BACKGROUND")
    tree.links.new(texture.outputs["Color"], background.inputs["Color"])
    return world


def _seen(sky: NDArray[np.float64]) -> NDArray[np.float64]:
    """Convert to display values from 0 to 1, with a soft shoulder."""
    colors = turned(sky)[: _HEIGHT // 2 + _GROUND].astype(np.float64)
    toned = 1.0 - np.exp(-_EXPOSURE * colors)
    return np.where(toned < 0.0031308, 12.92 * toned, 1.055 * toned ** (1 / 2.4) - 0.055)


def _framed(row: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.concatenate([row, np.ones((_GAP, row.shape[1], 3))])


if __name__ == "__main__":
    main()
