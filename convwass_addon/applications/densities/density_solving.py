# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Common context of all solves of densities: user-readable errors and one BLAS thread."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TypeVar

from ...errors import InputError
from ...progress import Work
from ...transport import KernelTooNarrowError, Surface
from ..workers import one_blas_thread
from .surface_densities import blur_of

Result = TypeVar("Result")


@contextmanager
def reachable(surface: Surface, names: Sequence[str]) -> Iterator[None]:
    """Convert the error for a kernel that is too narrow to one that users understand.

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


def solving(work: Work[Result], surface: Surface, names: Sequence[str]) -> Work[Result]:
    """Run work on a surface with one BLAS thread and with the errors of :func:`reachable`.

    Both apply while the work runs, not while its caller handles a report.
    """
    while True:
        try:
            with one_blas_thread(), reachable(surface, names):
                report = next(work)
        except StopIteration as end:
            return end.value
        yield report
