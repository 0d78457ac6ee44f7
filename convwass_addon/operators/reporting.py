# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Report errors and results to the user."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import wraps

import bpy

from ..applications.system_errors import error_to_tell
from ..errors import ConvwassError
from ..sentence import Sentence
from ..translations import translated

Execute = Callable[[bpy.types.Operator, bpy.types.Context], set[str]]


def refuse(operator: bpy.types.Operator, error: BaseException) -> set[str]:
    """Report an error that the user can act on, including a full disk, and cancel; raise any other error again."""
    known = error_to_tell(error)
    if known is None:
        raise error
    operator.report({"ERROR"}, translated(known.sentence))
    return {"CANCELLED"}


def reporting_errors(execute: Execute) -> Execute:
    """Let `execute` of an operator report errors that the user can act on, and cancel."""

    @wraps(execute)
    def reporting(self: bpy.types.Operator, context: bpy.types.Context) -> set[str]:
        try:
            return execute(self, context)
        except (ConvwassError, OSError, MemoryError) as error:
            return refuse(self, error)

    return reporting


def tell(
    operator: bpy.types.Operator, text: str, remarks: Sequence[Sentence] = (), warnings: Sequence[Sentence] = ()
) -> None:
    """Report a result with remarks and warnings, as a warning if there are any."""
    said = [text, *map(translated, (*warnings, *remarks))]
    operator.report({"WARNING"} if warnings else {"INFO"}, ". ".join(part.removesuffix(".") for part in said))
