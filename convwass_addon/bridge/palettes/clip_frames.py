# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Read the frames of an image sequence or movie, and show a sequence as an image."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import bpy

from ...applications.palettes.recolor_job import Picture
from ...errors import InputError
from ..files.image_files import image_path
from ..files.numbered_files import numbered_paths, split_number, with_number
from ..handles import Handle
from ..last_result import last_result
from ..morphs.disk.disk_output import for_blender
from .image_files import FORMATS
from .image_kinds import RESULT_OF, is_clip, source_of
from .image_pixels import read_picture


class ClipFrames:
    """The frames of a clip: all files of a sequence, or all frames of a movie. Must be used on the main thread.

    Scripts can only access the pixels of the most recently used frame. Evaluating a texture makes Blender use a given
    frame.

    Parameters
    ----------
    image : bpy.types.Image
        Not changed: frames are read with a copy.
    mask : bpy.types.Image or None
        Of the same size as the frames.

    Raises
    ------
    InputError
        There is no file, or a sequence has no numbers.
    """

    def __init__(self, image: bpy.types.Image, mask: bpy.types.Image | None = None) -> None:
        self.path = image_path(image)
        self.numbers = _sequence(self.path) if image.source == "SEQUENCE" else range(1, image.frame_duration + 1)
        if not len(self.numbers):
            raise InputError("There is no file {file}.", file=str(self.path))
        self._original, self._name = Handle.of("images", image), image.name
        self._mask = None if mask is None else Handle.of("images", mask)
        self._copy: Handle | None = None
        self._texture: Handle | None = None

    @property
    def names(self) -> list[str]:
        """File names of the recolored frames."""
        path = self.path
        if self.image.source == "SEQUENCE":
            known = path.suffix.lower() in FORMATS
            return [
                with_number(path, number).with_suffix(path.suffix if known else self._suffix).name
                for number in self.numbers
            ]
        return [other.name for other in numbered_paths(path.parent, f"{path.stem}.", self._suffix, self.numbers)]

    @property
    def image(self) -> bpy.types.Image:
        """The copy used for reading frames; created again if it was removed by undo.

        Raises
        ------
        InputError
            The image was deleted.
        """
        found = None if self._copy is None else self._copy.find()
        if found is None:
            gone = InputError("The image was deleted, or its creation undone, during the recoloring; start again.")
            found = self._original.living(gone).copy()
            self._copy = Handle.of("images", found)
        return found

    def read(self, place: int) -> Picture:
        """Read a frame with the mask.

        Raises
        ------
        InputError
            The frame cannot be read, or its size differs from the mask's.
        """
        image, texture = self.image, None if self._texture is None else self._texture.find()
        if texture is None:
            texture = bpy.data.textures.new("Frames", "IMAGE")
            self._texture = Handle.of("textures", texture)
        texture.image = image
        # Keep only one frame in memory.
        image.buffers_free()
        texture.image_user.frame_current = self.numbers[place]
        texture.evaluate((0.0, 0.0, 0.0))
        if not len(image.pixels):
            raise InputError(
                "Frame {number} of {image} could not be read.", number=self.numbers[place], image=self._name
            )
        mask = None if self._mask is None else self._mask.find()
        return read_picture(image, mask, self._name)

    def close(self) -> None:
        """Remove the temporary copy and texture."""
        gone = [own.find() for own in (self._texture, self._copy) if own is not None]
        bpy.data.batch_remove([block for block in gone if block is not None])
        self._texture = self._copy = None

    @property
    def _suffix(self) -> str:
        if not self.image.has_data:
            self.read(0)
        return ".exr" if self.image.is_float else ".png"


def sequence_image(source: bpy.types.Image, paths: Sequence[Path]) -> bpy.types.Image:
    """Return an image that shows files as a sequence: the previous result for the same clip, or a new one."""
    name = f"{source.name} recolored"
    image = last_result((own for own in bpy.data.images if source_of(own) == source and is_clip(own)), name)
    if image is None:
        image = bpy.data.images.load(str(paths[0]))
        image.name = name
        image[RESULT_OF] = source
    image.source, image.filepath = "SEQUENCE", for_blender(paths[0])
    # Discard cached frames of files with the same names.
    image.reload()
    return image


def first_number(path: Path) -> int:
    """Return the number of a file in a sequence."""
    return int(_split(path)[1])


def _split(path: Path) -> tuple[str, str, str]:
    found = split_number(path)
    if found is None:
        raise InputError("{file} has no number, so it is not part of an image sequence.", file=path.name)
    return found


def _sequence(path: Path) -> list[int]:
    """Return the numbers of all files of a sequence."""
    before, digits, after = _split(path)
    found = []
    for other in path.parent.glob("*") if path.parent.is_dir() else ():
        middle = other.name[len(before) : len(other.name) - len(after)]
        alike = other.name.startswith(before) and other.name.endswith(after) and len(middle) >= len(digits)
        if alike and middle.isascii() and middle.isdigit() and with_number(path, int(middle)).name == other.name:
            found.append(int(middle))
    return sorted(found)
