# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Input of the command ``recolor``: image files, or the frames of a movie."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Protocol

import bpy

from ..applications.palettes.recolor_job import Picture
from ..bridge.files.image_files import opened_image
from ..bridge.palettes.clip_frames import ClipFrames
from ..bridge.palettes.image_pixels import read_picture
from ..errors import InputError


class Frames(Protocol):
    """Pictures that share one color map.

    Attributes
    ----------
    names : list of str
        File names of the results.
    """

    names: list[str]

    def read(self, place: int) -> tuple[Picture, bpy.types.Image]:
        """Return a context with a picture and the image that defines its pixel format."""


@contextmanager
def opened_frames(paths: Sequence[Path], mask: Path | None) -> Iterator[Frames]:
    """Open the images or the movie to recolor.

    Raises
    ------
    InputError
        A file is missing, or a movie is combined with other files.
    """
    movies = [path for path in paths if path.suffix.lower() in bpy.path.extensions_movie]
    if not movies:
        yield _Files(paths, mask)
        return
    if len(paths) > 1:
        raise InputError("A movie must be the only input; {movie} is one.", movie=movies[0].name)
    with ExitStack() as stack:
        movie = stack.enter_context(opened_image(movies[0]))
        frames = ClipFrames(movie, None if mask is None else stack.enter_context(opened_image(mask)))
        stack.callback(frames.close)
        yield _Movie(frames)


@contextmanager
def read_file(path: Path, mask: Path | None) -> Iterator[tuple[Picture, bpy.types.Image]]:
    """Provide an image with its mask as a context."""
    with ExitStack() as stack:
        image = stack.enter_context(opened_image(path))
        own = None if mask is None else stack.enter_context(opened_image(mask))
        yield read_picture(image, own), image


class _Files:
    def __init__(self, paths: Sequence[Path], mask: Path | None) -> None:
        self._paths, self._mask = paths, mask
        self.names = [path.name for path in paths]

    def read(self, place: int) -> tuple[Picture, bpy.types.Image]:
        return read_file(self._paths[place], self._mask)


class _Movie:
    def __init__(self, frames: ClipFrames) -> None:
        self._frames, self.names = frames, frames.names

    @contextmanager
    def read(self, place: int) -> Iterator[tuple[Picture, bpy.types.Image]]:
        yield self._frames.read(place), self._frames.image
