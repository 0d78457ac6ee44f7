# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The frames of a sequence of images, or of a movie, as pictures; and a sequence as an image that shows it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import bpy

from ...applications.palettes.recolor_job import Picture
from ...errors import InputError
from ..handles import Handle
from ..numbered_files import numbered_paths
from .image_files import FORMATS
from .image_kinds import RESULT_OF, is_clip
from .image_pixels import read_picture


class ClipFrames:
    """The frames of a clip: all files of the sequence, or all of the movie. Everything belongs on the main thread.

    Blender gives scripts the pixels of the frame that was used last. A texture that is asked for a color uses the frame
    that it is told to.

    Parameters
    ----------
    image : bpy.types.Image
        Stays as it is: frames are read into a copy.
    mask : bpy.types.Image or None
        Of the size of all frames.

    Raises
    ------
    InputError
        No file, or a sequence without numbers.
    """

    def __init__(self, image: bpy.types.Image, mask: bpy.types.Image | None = None) -> None:
        self.path = Path(bpy.path.abspath(image.filepath, library=image.library))
        self.numbers = _sequence(self.path) if image.source == "SEQUENCE" else range(1, image.frame_duration + 1)
        if not len(self.numbers):
            raise InputError("There is no file {file}.", file=str(self.path))
        self._original = Handle.of("images", image)
        self._mask = None if mask is None else Handle.of("images", mask)
        self._copy: Handle | None = None
        self._texture: Handle | None = None

    @property
    def names(self) -> list[str]:
        """The names of the files that the recolored frames go to."""
        path = self.path
        if self.image.source == "SEQUENCE":
            known = path.suffix.lower() in FORMATS
            return [
                _numbered(path, number).with_suffix(path.suffix if known else self._suffix).name
                for number in self.numbers
            ]
        return [other.name for other in numbered_paths(path.parent, f"{path.stem}.", self._suffix, self.numbers)]

    @property
    def image(self) -> bpy.types.Image:
        """The copy that frames are read into; made again where undoing has removed it.

        Raises
        ------
        InputError
            The image itself is gone.
        """
        found = None if self._copy is None else self._copy.find()
        if found is None:
            original = self._original.find()
            if original is None:
                raise InputError("What was recolored was deleted, or undone, meanwhile; start again.")
            found = original.copy()
            self._copy = Handle.of("images", found)
        return found

    def read(self, place: int) -> Picture:
        """Read a frame, with the mask.

        Raises
        ------
        InputError
            It cannot be read, or has another size than the mask.
        """
        image, texture = self.image, None if self._texture is None else self._texture.find()
        if texture is None:
            texture = bpy.data.textures.new("Frames", "IMAGE")
            self._texture = Handle.of("textures", texture)
        texture.image = image
        # One frame in memory is enough.
        image.buffers_free()
        texture.image_user.frame_current = self.numbers[place]
        texture.evaluate((0.0, 0.0, 0.0))
        if not len(image.pixels):
            raise InputError(
                "Frame {number} of {image} could not be read.", number=self.numbers[place], image=image.name
            )
        mask = None if self._mask is None else self._mask.find()
        return read_picture(image, mask)

    def close(self) -> None:
        """Remove what was made for reading."""
        gone = [own.find() for own in (self._texture, self._copy) if own is not None]
        bpy.data.batch_remove([block for block in gone if block is not None])
        self._texture = self._copy = None

    @property
    def _suffix(self) -> str:
        if not self.image.has_data:
            self.read(0)
        return ".exr" if self.image.is_float else ".png"


def sequence_image(source: bpy.types.Image, paths: Sequence[Path]) -> bpy.types.Image:
    """Return an image that shows files as a sequence: the last result for the same clip, or a new one."""
    for image in bpy.data.images:
        if image.get(RESULT_OF) == source.name and is_clip(image) and image.library is None:
            break
    else:
        image = bpy.data.images.load(str(paths[0]))
        image.name = f"{source.name} recolored"
        image[RESULT_OF] = source.name
    image.source, image.filepath = "SEQUENCE", str(paths[0])
    # What was read from files of these names before is out of date.
    image.reload()
    return image


def first_number(path: Path) -> int:
    """Return the number of a file of a sequence."""
    return int(_split(path)[1])


def _split(path: Path) -> tuple[str, str, str]:
    """Split a name as Blender does: what comes before the last digits, these, and the rest."""
    found = re.fullmatch(r"(.*?)([0-9]+)([^0-9]*)", path.stem)
    if found is None:
        raise InputError("{file} has no number, so it is no sequence of images.", file=path.name)
    return found.group(1), found.group(2), found.group(3) + path.suffix


def _numbered(path: Path, number: int) -> Path:
    before, digits, after = _split(path)
    return path.with_name(f"{before}{number:0{len(digits)}d}{after}")


def _sequence(path: Path) -> list[int]:
    """Return the numbers of all files of a sequence."""
    before, digits, after = _split(path)
    found = []
    for other in path.parent.glob("*") if path.parent.is_dir() else ():
        middle = other.name[len(before) : len(other.name) - len(after)]
        alike = other.name.startswith(before) and other.name.endswith(after) and len(middle) >= len(digits)
        if alike and middle.isascii() and middle.isdigit() and _numbered(path, int(middle)).name == other.name:
            found.append(int(middle))
    return sorted(found)
