# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Mark a baked morph for the Asset Browser, with a picture of its middle blend."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

import bpy
import numpy as np

from ....errors import Cancelled, ConvwassError
from ...files.image_files import opened_image, pixel_values
from ...studio.framing import broad_view, orbit
from ...studio.rendered_scene import Studio, opening, world_points
from ..players.player_inputs import is_player
from ..stand_ins import frames_modifier, stand_ins
from ..stored import frame_objects, stored_morph
from .contact_sheet import ELEVATION

# Width and height of preview pictures in pixels, and light paths per pixel.
_SIDE, _SAMPLES = 256, 12
_TAG = "morph"


def mark_as_assets(collection: bpy.types.Collection) -> list[bpy.types.ID]:
    """Mark what shows a morph as assets, or update the assets.

    These are the player, its node group (for any moment, if it interpolates) and its materials, except those that are
    assets of the user; for a pad and for a morph without a player, the collection.

    Parameters
    ----------
    collection : bpy.types.Collection
        A finished morph.

    Returns
    -------
    list of bpy.types.ID
        The assets, each with a description, a tag and a preview picture.

    Raises
    ------
    InputError
        The collection is not a morph.
    """
    # The names as they were; the inputs may be gone.
    description = " > ".join(stored_morph(collection).inputs)
    picture = _picture(collection)
    marked = asset_blocks(collection)
    for block in marked:
        block.asset_mark()
        block.asset_data.description = description
        block.asset_data.tags.new(_TAG, skip_if_exists=True)
        if picture is None:
            block.asset_generate_preview()
        else:
            preview = block.preview_ensure()
            preview.image_size = picture.shape[:2]
            preview.image_pixels_float.foreach_set(picture.ravel())
    return marked


def asset_blocks(collection: bpy.types.Collection) -> list[bpy.types.ID]:
    """Return the data-blocks of a morph that become assets; see `mark_as_assets`."""
    player = next((obj for obj in stand_ins(collection) if obj.users_scene and is_player(obj)), None)
    if player is None:
        return [collection]
    tree = frames_modifier(player).node_group
    # An interpolating player has a group for any moment, which is marked from the start.
    groups = [node.node_tree for node in tree.nodes if node.type == "GROUP" and node.node_tree.asset_data is not None]
    materials = [slot.material for slot in player.material_slots if slot.material and not _is_own_asset(slot.material)]
    return [player, *dict.fromkeys(groups or [tree]), *dict.fromkeys(materials)]


def _is_own_asset(material: bpy.types.Material) -> bool:
    """Return whether the user made an asset of a material, whose description and preview are kept."""
    return material.asset_data is not None and _TAG not in material.asset_data.tags


def _picture(collection: bpy.types.Collection) -> np.ndarray | None:
    """Render the middle blend, (h, w, 4) float32 from the bottom row; None if there are no meshes or no renderer."""
    frames: Sequence[bpy.types.Object] = [obj for obj in frame_objects(collection) if obj.type == "MESH"]
    if not frames:
        return None
    frame = frames[len(frames) // 2]
    points = world_points(frame)
    view = broad_view([points], ELEVATION)
    size = (_SIDE, _SIDE)
    try:
        with tempfile.TemporaryDirectory(prefix="convwass-") as folder, Studio() as studio:
            studio.show(frame)
            reach = studio.build([points], view)
            studio.look(orbit(points, [view], opening(size))[0], reach)
            studio.set_quality(size, _SAMPLES)
            path = Path(folder) / "preview.png"
            studio.render(path)
            with opened_image(path) as image:
                return pixel_values(image)
    except Cancelled:
        raise
    except ConvwassError:
        # Without Cycles, Blender makes the picture.
        return None
