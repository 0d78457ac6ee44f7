# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What all solves of densities have in common: they can be stopped, and say why they cannot work."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

from ...errors import InputError
from ...transport import KernelTooNarrowError, Surface
from .surface_densities import blur_of

Check = Callable[[], None]
"""Called between iterations; what it raises (:class:`.errors.Cancelled`) ends the work."""


def monitor_of(check: Check | None) -> Callable[[int, int, float], None] | None:
    """Turn a check into what solvers call once per iteration."""
    return None if check is None else lambda *_: check()


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
