# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Recolor an image sequence or a movie with one color map for all frames, in the background."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from ..applications.palettes.palette_settings import RecolorSettings
from ..applications.whole_paths import share_a_place
from ..bridge.files.image_files import image_path
from ..bridge.files.output_paths import checked_folder
from ..bridge.handles import Handle
from ..bridge.palettes.image_files import save_pixels
from ..bridge.palettes.image_kinds import is_clip, source_of
from ..drafts import DraftFiles
from ..errors import InputError
from ..progress import UNINTERRUPTED, Control, Progress, Work
from ..properties.recolor import RecolorProperties, clip_folder_property
from ..sentence import Sentence
from .background import BackgroundOperator
from .recolor_targets import OnImage, chosen_image, image_property, read_palettes, shown_image
from .reporting import tell

if TYPE_CHECKING:
    from ..applications.palettes.clip_job import FrameRequest, RecoloredFrame
    from ..applications.palettes.recolor_job import Picture
    from ..applications.palettes.recoloring import Recoloring
    from ..bridge.palettes.clip_frames import ClipFrames


class ClipJob:
    """Recolors a clip. All methods except :meth:`steps` must be called on the main thread.

    Parameters
    ----------
    frames : ClipFrames
        The frames to measure and recolor.
    palettes, weights
        The palettes of the result.
    settings : RecolorSettings
        Settings of the color map.
    targets : sequence of Path
        Output files, one per frame; empty to compute only the map.
    """

    def __init__(
        self,
        frames: ClipFrames,
        palettes: Sequence[Picture],
        weights: Sequence[float],
        settings: RecolorSettings,
        targets: Sequence[Path] = (),
    ) -> None:
        self._frames, self._targets = frames, list(targets)
        self._inputs = palettes, weights, settings
        self._drafts = DraftFiles()
        self.change: Recoloring | None = None

    def steps(self, control: Control = UNINTERRUPTED) -> Work[None]:
        """Compute the color map, and recolor the frames if there are targets."""
        from ..applications.palettes.clip_job import clip_map_steps, clip_steps

        work = clip_steps if self._targets else clip_map_steps
        self.change = yield from work(len(self._frames.numbers), *self._inputs, control)

    def write(self, report: Progress[FrameRequest | RecoloredFrame]) -> None:
        """Read the requested frame, or write a recolored frame."""
        from ..applications.palettes.clip_job import FrameRequest, RecoloredFrame

        found = report.payload
        if isinstance(found, FrameRequest):
            found.answer(self._frames.read(found.place))
        elif isinstance(found, RecoloredFrame):
            save_pixels(found.pixels, self._frames.image, self._drafts.draft_of(self._targets[found.place]))

    def discard(self) -> None:
        """Remove drafts and temporary data."""
        self._drafts.discard()
        self._frames.close()

    def keep(self) -> list[Path]:
        """Move the finished files into place, and return their paths."""
        try:
            return self._drafts.keep()
        finally:
            self.discard()


class CONVWASS_OT_recolor_clip(RecolorProperties, BackgroundOperator, OnImage, bpy.types.Operator):
    """Transfer the palette of another image, or a blend of several, to all frames of a sequence or a movie, with one color map computed from all frames together, so that nothing flickers. Existing files are only replaced once all frames are finished"""  # noqa: E501

    bl_idname = "convwass.recolor_clip"
    bl_label = "Recolor Clip"
    _title = Sentence("Recoloring")

    image: image_property()
    folder: clip_folder_property()

    _name: str
    _image: Handle

    @classmethod
    def poll(cls, context):
        image = shown_image(context)
        if image is not None and not is_clip(image):
            cls.poll_message_set("Open a sequence of images or a movie")
            return False
        return super().poll(context)

    def _begin(self, context):
        from ..bridge.palettes.clip_frames import ClipFrames

        image = chosen_image(context, self.image)
        if not is_clip(image):
            raise InputError("{image} is neither a sequence of images nor a movie.", image=image.name)
        folder, own = checked_folder(self.folder), context.scene.convwass_recolor
        frames = ClipFrames(image, own.mask)
        if share_a_place([folder], [frames.path.parent]):
            raise InputError(
                "The results would overwrite the frames of {image}; choose another folder.", image=image.name
            )
        self._name, self._image = image.name, Handle.of("images", image)
        try:
            targets = [folder / name for name in frames.names]
            _require_own(image, targets)
            return ClipJob(frames, *read_palettes(context), self.recolor_settings(), targets)
        except BaseException:
            frames.close()
            raise

    def _finish(self, context, job):
        from ..bridge.palettes.clip_frames import sequence_image

        paths = job.keep()
        source = self._image.find()
        if source is not None:
            _show(context, source, sequence_image(source, paths), paths)
        text = rpt_("Recolored {:d} frames of {:s}, in {:s}")
        tell(self, text.format(len(paths), self._name, str(paths[0].parent)))
        return {"FINISHED"}


def _require_own(image: bpy.types.Image, targets: Sequence[Path]) -> None:
    """Raise InputError if files are the recolored frames of another clip in the .blend file."""
    for other in bpy.data.images:
        source = source_of(other)
        if source in (None, image) or not is_clip(other):
            continue
        if share_a_place(targets, [image_path(other)]):
            raise InputError("The results would overwrite those of {image}; choose another folder.", image=source.name)


def _show(context: bpy.types.Context, source: bpy.types.Image, result: bpy.types.Image, paths: Sequence[Path]) -> None:
    """Show the result in the editor that shows the clip."""
    from ..bridge.palettes.clip_frames import first_number

    space = context.space_data
    if space is None or space.type != "IMAGE_EDITOR" or space.image not in (source, result):
        return
    space.image = result
    space.image_user.frame_duration, space.image_user.frame_offset = len(paths), first_number(paths[0]) - 1


classes = (CONVWASS_OT_recolor_clip,)
