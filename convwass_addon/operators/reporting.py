# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How operators tell the user what went wrong, and what has come of their work."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ..applications.system_errors import error_to_tell
from ..errors import ConvwassError
from ..sentence import Sentence
from ..translations import translated

# So many names are told of those that there are.
_NAMED = 5


def refuse(operator: bpy.types.Operator, error: ConvwassError) -> set[str]:
    """Report an error in the user's language; return what an operator returns that gives up."""
    operator.report({"ERROR"}, translated(error.sentence))
    return {"CANCELLED"}


def refuse_if_known(operator: bpy.types.Operator, error: BaseException) -> set[str]:
    """Report whatever the user can act on, full disks included; raise all else again."""
    known = error_to_tell(error)
    if known is None:
        raise error
    return refuse(operator, known)


def tell(
    operator: bpy.types.Operator, text: str, remarks: Sequence[Sentence] = (), warnings: Sequence[Sentence] = ()
) -> None:
    """Report a result with what should be known about it; as a warning where there are some."""
    said = [text, *map(translated, (*warnings, *remarks))]
    operator.report({"WARNING"} if warnings else {"INFO"}, ". ".join(part.removesuffix(".") for part in said))


def listed(names: Sequence[str]) -> str:
    """Write names with commas between them, not without end."""
    return ", ".join([*names[:_NAMED], *(["..."] if len(names) > _NAMED else [])])
