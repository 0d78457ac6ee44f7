# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Convert system errors to errors for the user."""

from __future__ import annotations

from ..errors import ConvwassError, ResourceError


def error_to_tell(error: BaseException) -> ConvwassError | None:
    """Return an error as one that can be shown to the user; None for defects and irrelevant errors.

    Full disks, missing folders and insufficient memory can occur anywhere.
    """
    if isinstance(error, ConvwassError):
        return error
    if isinstance(error, MemoryError):
        return ResourceError("There is not enough memory for this; close other programs, or ask for less detail.")
    if isinstance(error, OSError):
        reason = error.strerror or str(error) or type(error).__name__
        if error.filename is None:
            return ConvwassError("The system refused to read or write: {reason}.", reason=reason)
        return ConvwassError("{file} cannot be read or written: {reason}.", file=str(error.filename), reason=reason)
    return None
