# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What all solves of densities have in common: they say why they cannot work."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from ...errors import InputError
from ...transport import KernelTooNarrowError, Surface
from .surface_densities import blur_of


@contextmanager
def reachable(surface: Surface, names: Sequence[str]) -> Iterator[None]:
    """Say in the user's words that a kernel is too narrow for the way.

    Raises
    ------
    InputError
        Instead of :class:`.transport.KernelTooNarrowError`.
    """
    try:
        yield
    except KernelTooNarrowError as error:
        raise InputError(
            "A blur of {blur:.3g} is too short to carry mass between {names}; try {longer:.3g}.",
            blur=blur_of(surface),
            names=", ".join(dict.fromkeys(names)),
            longer=1.5 * blur_of(surface),
        ) from error
