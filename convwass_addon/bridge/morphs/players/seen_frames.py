# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The frames of a morph as they are seen: those that were baked, or what a player with another timing shows."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Matrix

from ....errors import InputError
from ....progress import Work
from ...keyframes import curves_of
from ...visibility import is_in
from ..removal import remove_bake
from ..stand_ins import frames_modifier, shown_morph, stand_ins
from ..stored import WEIGHTS_KEY, frame_objects, frame_times, frame_weights, shown_frames
from .dense_bake import bake_player, sample_times
from .player_inputs import (
    SAME_MOMENT,
    interpolation,
    is_player,
    morph_value,
    override,
    playback_item,
    shown_value,
    speed,
)
from .retiming import keyed_span, sole_curve


@dataclass(frozen=True)
class SeenFrames:
    """Frames to write.

    Attributes
    ----------
    morph : bpy.types.Collection
        The morph with the frames.
    player : bpy.types.Object or None
        The player from which they were made; None if they are those of the bake.
    """

    morph: bpy.types.Collection
    player: bpy.types.Object | None = None

    def keep(self) -> None:
        """Hide the player from which the frames were made."""
        if self.player is not None:
            self.player.hide_viewport = self.player.hide_render = True

    def discard(self) -> None:
        """Remove frames that were made from a player."""
        if self.player is not None:
            remove_bake(self.morph)


def seen_frames(morph: bpy.types.Collection, active: bpy.types.Object | None) -> Work[SeenFrames]:
    """Return the frames of a morph as they are seen.

    If a player shows them as they were baked, they are those of the bake. If it was retimed, moved, modified or has
    materials of its own, a morph is made with a frame for every scene frame from its first key to its last.

    Parameters
    ----------
    morph : bpy.types.Collection
        A baked morph.
    active : bpy.types.Object or None
        The player to use of several.

    Yields
    ------
    Progress
        After each frame that is made.

    Raises
    ------
    InputError
        The player is in a collection that is excluded from the view layer, or as :func:`.dense_bake.bake_player`.
    """
    players = [obj for obj in stand_ins(morph) if obj.users_scene and is_player(obj)]
    if all(shows_as_baked(player) for player in players):
        return SeenFrames(morph)
    player = active if active in players else players[0]
    _require_evaluated(player)
    render = bpy.context.scene.render
    first, last = keyed_span(player)
    rate = render.fps / render.fps_base
    with _visible(player):
        made = yield from bake_player(player, sample_times(first, last, rate, rate), first)
    return SeenFrames(made, player)


def _require_evaluated(player: bpy.types.Object) -> None:
    """Raise InputError if Blender does not evaluate a player because its collection is excluded."""
    layer = bpy.context.view_layer
    # A script may have excluded it just now.
    layer.update()
    if not is_in(layer, player):
        raise InputError(
            "{player} is not in the view layer {layer}, so it shows nothing that could be written; include its "
            "collection there.",
            player=player.name,
            layer=layer.name,
        )


@contextmanager
def _visible(player: bpy.types.Object) -> Iterator[None]:
    """Show a player meanwhile: Blender does not evaluate hidden objects."""
    before = player.hide_viewport, player.hide_render, player.hide_get()
    player.hide_viewport = False
    player.hide_set(False)
    try:
        yield
    finally:
        player.hide_viewport, player.hide_render, eye = before
        player.hide_set(eye)


def shows_as_baked(player: bpy.types.Object) -> bool:
    """Return whether a player shows every baked frame at its time and place, and nothing else."""
    return _is_in_place(player) and not _has_own_look(player) and _plays_as_baked(player)


def _is_in_place(player: bpy.types.Object) -> bool:
    """Return whether a player is neither moved nor modified."""
    own = [value.data_path for value in (morph_value(player), speed(player)) if value is not None]
    moves = [curve for curve in curves_of(player) if curve.data_path not in own]
    changes = [modifier for modifier in player.modifiers if modifier != frames_modifier(player)]
    driven = player.animation_data is not None and player.animation_data.drivers
    return not (moves or driven or changes or player.constraints or player.parent) and player.matrix_basis == Matrix()


def _has_own_look(player: bpy.types.Object) -> bool:
    """Return whether a player shows other materials than the baked frames."""
    return override(player).get() or any(slot.link == "OBJECT" for slot in player.material_slots)


def _plays_as_baked(player: bpy.types.Object) -> bool:
    """Return whether a player shows the baked frames in their order and at their speed."""
    morph = shown_morph(player)
    frames, span = frame_objects(morph), shown_frames(morph)
    curve = sole_curve(player)
    if curve is None or keyed_span(player) != (span[0], span[-1]):
        return False
    if len(frames) < len(span) and interpolation(player) is not None:
        # It shows the moments between frames that are held.
        return False
    last, item = len(frames[0][WEIGHTS_KEY]) - 1, playback_item(player)
    shown = np.array([shown_value(curve.evaluate(time), item, last) for time in frame_times(morph)])
    baked = frame_weights(frames) @ np.arange(last + 1)
    return bool(np.abs(shown - baked).max() < SAME_MOMENT)
