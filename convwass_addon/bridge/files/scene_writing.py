# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write the current scene with Blender's exporters, whose status is returned and checked."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import bpy

from ...disk_space import require_whole
from ...errors import ConvwassError
from ..interrupts import kept_interrupts
from ..operator_errors import reason


def write_still_gltf(file: str) -> set[str]:
    """Write a glTF file without animation."""
    with kept_interrupts():
        return bpy.ops.export_scene.gltf(
            filepath=file, export_format="GLB", use_active_scene=True, export_animations=False, export_extras=False
        )


def write_usd(file: str) -> set[str]:
    """Write a USD file of all frames."""
    return bpy.ops.wm.usd_export(
        filepath=file, export_animation=True, evaluation_mode="RENDER", convert_world_material=False
    )


def write_alembic(file: str, colors: bool) -> set[str]:
    """Write an Alembic file of all frames, with the colors of corners or without."""
    scene = bpy.context.scene
    return bpy.ops.wm.alembic_export(
        filepath=file, start=scene.frame_start, end=scene.frame_end, evaluation_mode="RENDER", vcolors=colors
    )


def write_draft(write: Callable[[str], set[str]], draft: Path, target: Path) -> None:
    """Write a draft with one of Blender's exporters; raises ConvwassError, which names the target, if that fails."""
    try:
        status = write(str(draft))
    except RuntimeError as error:
        raise ConvwassError("{file} could not be written: {reason}", file=str(target), reason=reason(error)) from error
    if "FINISHED" not in status or not draft.is_file():
        raise ConvwassError("{file} could not be written.", file=str(target))
    require_whole(draft, target)
