# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the command ``recolor`` reads: image files, or the frames of a movie."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Protocol

import bpy

from ..applications.palettes.recolor_job import Picture
from ..bridge.image_files import opened_image
from ..bridge.palettes.clip_frames import ClipFrames
from ..bridge.palettes.image_pixels import read_picture
from ..errors import InputError


class Frames(Protocol):
    """Pictures that are graded alike.

    Attributes
    ----------
    names : list of str
        Of the files that they go to.
    """

    names: list[str]

    def read(self, place: int) -> tuple[Picture, bpy.types.Image]:
        """Give a context with one of them, and the image that says what its pixels mean."""


@contextmanager
def opened_frames(paths: Sequence[Path], mask: Path | None) -> Iterator[Frames]:
    """Open what is recolored.

    Raises
    ------
    InputError
        A file that is missing, or a movie among others.
    """
    movies = [path for path in paths if path.suffix.lower() in bpy.path.extensions_movie]
    if not movies:
        yield _Files(paths, mask)
        return
    if len(paths) > 1:
        raise InputError("A movie is recolored by itself; {movie} is one.", movie=movies[0].name)
    with ExitStack() as stack:
        movie = stack.enter_context(opened_image(movies[0]))
        frames = ClipFrames(movie, None if mask is None else stack.enter_context(opened_image(mask)))
        stack.callback(frames.close)
        yield _Movie(frames)


@contextmanager
def read_file(path: Path, mask: Path | None) -> Iterator[tuple[Picture, bpy.types.Image]]:
    """Read an image and its mask for as long as the context lasts."""
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
