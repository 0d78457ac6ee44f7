# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Give an image the palette of others, in the background."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_
from numpy.typing import NDArray

from ..applications.palettes.palette_settings import RecolorSettings
from ..applications.palettes.png_bytes import png_bytes
from ..bridge.handles import Handle
from ..bridge.palettes.image_kinds import is_clip
from ..errors import InputError
from ..progress import UNINTERRUPTED, Control, Progress, Work, within
from ..properties.recolor import RecolorProperties, output_property
from ..sentence import Sentence
from .background import BackgroundOperator, Job
from .recolor_targets import OnImage, chosen_image, image_property, palette_names, read_pictures
from .reporting import tell

if TYPE_CHECKING:
    from ..applications.palettes.recolor_job import Picture
    from ..applications.palettes.recoloring import Recoloring

# Share of the progress at which the pixels are finished, if they are then encoded to a file.
_RECOLORED = 0.95


class RecolorJob(Job):
    """Recolors a picture. All methods except :meth:`steps` must be called on the main thread.

    Parameters
    ----------
    target : Handle
        The data-block that receives the result.
    source : Picture
        The picture to recolor.
    palettes : sequence of Picture
        The palettes of the result.
    weights : sequence of float
        One per palette.
    settings : RecolorSettings
        Settings of the color map.
    ends : "map", "pixels" or "file"
        The kind of result. A file is only encoded for 8-bit pixels, where encoding takes most of the time for packing.
    """

    def __init__(
        self,
        target: Handle,
        source: Picture,
        palettes: Sequence[Picture],
        weights: Sequence[float],
        settings: RecolorSettings,
        *,
        ends: Literal["map", "pixels", "file"] = "pixels",
    ) -> None:
        self._target = target
        self._inputs = source, palettes, weights, settings
        self._ends = ends
        self.change: Recoloring | None = None
        self.file: bytes | None = None
        self.pixels: NDArray[np.float32] | None = None

    def steps(self, control: Control = UNINTERRUPTED) -> Work[None]:
        """Compute the result and keep it."""
        from ..applications.palettes.recolor_job import map_steps, recolor_steps

        if self._ends == "map":
            self.change = yield from map_steps(*self._inputs, control)
            return
        packs = self._ends == "file" and bool(self._inputs[0].pixel_format.levels)
        found = yield from within(recolor_steps(*self._inputs, control), 0.0, _RECOLORED if packs else 1.0)
        self.change, self.pixels = found.change, found.pixels
        if packs:
            yield Progress(_RECOLORED, Sentence("Packing the image"))
            self.file = png_bytes(found.pixels, control)

    def discard(self) -> None:
        """Discard the result."""
        self.pixels = self.file = None

    def target(self) -> bpy.types.ID:
        """Return the data-block that receives the result; raises InputError if it was deleted."""
        return self._target.living(
            InputError("The image or object was deleted, or its creation undone, during the recoloring; start again.")
        )


class CONVWASS_OT_recolor_image(RecolorProperties, BackgroundOperator, OnImage, bpy.types.Operator):
    """Transfer the palette of another image, or a blend of several, to this image. The color map is an optimal transport map, which changes colors as little as possible in total. Replacing the pixels of an image cannot be undone; reload the image instead"""  # noqa: E501

    bl_idname = "convwass.recolor_image"
    bl_label = "Recolor Image"
    _title = Sentence("Recoloring")

    image: image_property()
    output: output_property()

    _palettes: list[str]

    def _begin(self, context):
        from ..bridge.palettes.image_pixels import require_local

        image = chosen_image(context, self.image)
        if self.output == "REPLACE":
            require_local(image)
        if self.output == "REPLACE" and is_clip(image):
            raise InputError(
                "{image} is a clip, whose frames cannot be changed; make a new image, or recolor the clip.",
                image=image.name,
            )
        self._palettes = palette_names(context)
        inputs, ends = read_pictures(context, image), "file" if self.output == "NEW" else "pixels"
        return RecolorJob(Handle.of("images", image), *inputs, self.recolor_settings(), ends=ends)

    def _finish(self, context, job):
        from ..bridge.palettes.image_pixels import keep_in_file, result_image, write_pixels

        image = job.target()
        result = image if self.output == "REPLACE" else result_image(image)
        if job.file is None:
            write_pixels(result, job.pixels)
        if result != image:
            keep_in_file(result, job.file)
        space = context.space_data
        if space is not None and space.type == "IMAGE_EDITOR" and space.image == image:
            space.image = result
        tell(self, rpt_("{:s} has the colors of {:s}").format(result.name, ", ".join(self._palettes)))
        return {"FINISHED"}


classes = (CONVWASS_OT_recolor_image,)
