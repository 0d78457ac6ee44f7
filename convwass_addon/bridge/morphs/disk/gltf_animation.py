# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Animated visibility in glTF files, which lack it: nodes scaled by 0 or 1."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import bpy

from ...interrupts import kept_interrupts
from ...keyframes import key_scale
from ...objects import world_copy


@contextmanager
def scaled_stand_ins(
    frames: Sequence[bpy.types.Object], shown: Sequence[Sequence[bpy.types.Object]], name: str
) -> Iterator[list[bpy.types.Object]]:
    """Create objects with world-space copies of the meshes of frames, scaled to zero while these are hidden.

    The specification of glTF 2.0 suggests this way to hide nodes (section "Transformations").

    Parameters
    ----------
    frames : sequence of bpy.types.Object
        All frame objects of a path.
    shown : sequence of sequence of bpy.types.Object
        Those that are shown in each scene frame, the first of which becomes frame 0; the last is shown for one frame.
    name : str
        Name of the action and of the objects, which get numbers from 0001.

    Yields
    ------
    list of bpy.types.Object
        Not linked to a scene; their scales have constant keys, all in one action.
    """
    action = bpy.data.actions.new(name)
    copies = []
    try:
        for number, obj in enumerate(frames, start=1):
            # In world space, since a node that is scaled to zero has lost its rotation for the exporter.
            copy = world_copy(obj, f"{name}_{number:04d}")
            copies.append(copy)
            seen = [obj in objects for objects in shown]
            keys = [(number, now) for number, now in enumerate(seen) if now != seen[number - 1] or number == 0]
            keys.append((len(seen), seen[-1]))
            for axis in range(3):
                key_scale(copy, action, axis, keys)
        yield copies
    finally:
        bpy.data.batch_remove([*copies, *(copy.data for copy in copies), action])


def write_gltf_animation(file: str, **options: bool) -> set[str]:
    """Write the context's scene with its keys as they are, not sampled, so that constant keys remain steps.

    Parameters
    ----------
    file : str
        The path of a .glb file.
    **options : bool
        Further options of Blender's exporter.
    """
    with kept_interrupts():
        return bpy.ops.export_scene.gltf(
            filepath=file,
            export_format="GLB",
            use_active_scene=True,
            export_animation_mode="ACTIONS",
            export_force_sampling=False,
            export_optimize_animation_size=False,
            export_extras=False,
            **options,
        )
