# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Join pictures to a video, with Blender's sequencer and encoder."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

import bpy

from ...errors import ConvwassError
from ..color_spaces import show_unchanged
from .rendered_scene import move_result, run_render


def write_video(pictures: Sequence[Path], target: Path, resolution: tuple[int, int], frames_per_second: int) -> None:
    """Write an MP4 video (H.264) from pictures, one per frame.

    Parameters
    ----------
    pictures : sequence of Path
        Files in one folder; pictures may be repeated.
    target : Path
        Replaced if it exists; the folder must exist.
    resolution : (int, int)
        Width and height in pixels, both even.
    frames_per_second : int
        Frame rate of the video.

    Raises
    ------
    ConvwassError
        Blender was built without video output, or could not write the file.
    """
    scene = bpy.data.scenes.new("Convwass Video")
    try:
        _set_output(scene, resolution, frames_per_second)
        strip = scene.sequence_editor_create().strips.new_image("Morph", str(pictures[0]), channel=1, frame_start=1)
        for picture in pictures[1:]:
            strip.elements.append(picture.name)
        scene.frame_start, scene.frame_end = 1, len(pictures)
        with tempfile.TemporaryDirectory(prefix="convwass-") as folder:
            video = Path(folder) / "video.mp4"
            scene.render.filepath = str(video)
            run_render(scene, animation=True)
            move_result(video, target)
    finally:
        bpy.data.scenes.remove(scene)


def _set_output(scene: bpy.types.Scene, resolution: tuple[int, int], frames_per_second: int) -> None:
    """Set size, frame rate, encoding, and unmodified colors."""
    render = scene.render
    render.resolution_x, render.resolution_y = resolution
    render.resolution_percentage = 100
    render.fps, render.fps_base = frames_per_second, 1.0
    show_unchanged(scene)
    try:
        if hasattr(render.image_settings, "media_type"):  # Blender 5
            render.image_settings.media_type = "VIDEO"
        render.image_settings.file_format = "FFMPEG"
    except TypeError as error:
        raise ConvwassError(
            "This Blender was built without video output; get one from blender.org, or render the morph's frames "
            "as pictures."
        ) from error
    render.ffmpeg.format = "MPEG4"
    render.ffmpeg.codec = "H264"
    render.ffmpeg.constant_rate_factor = "HIGH"
    render.ffmpeg.audio_codec = "NONE"
