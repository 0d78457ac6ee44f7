# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A `repr` on a single line for records with arrays."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import is_dataclass

import numpy as np

# Marks records that are shown by type only within another record.
_NAME = "represent_on_one_line"
# Arrays with at most this many values are shown in full.
_FEW = 4


def one_line(*names: str) -> Callable[[object], str]:
    """Return a ``__repr__`` that shows some attributes: type and shape of arrays, numbers with four digits.

    Parameters
    ----------
    *names : str
        Attributes, in display order.
    """

    def represent_on_one_line(record: object) -> str:
        shown = ", ".join(f"{name}={_short(getattr(record, name))}" for name in names)
        return f"{type(record).__name__}({shown})"

    return represent_on_one_line


def _short(value: object) -> str:
    if isinstance(value, np.ndarray) and (value.ndim != 1 or value.size > _FEW):
        return f"<{value.dtype} {value.shape}>"
    if isinstance(value, np.ndarray | tuple | list):
        if len(value) > _FEW:
            return f"<{len(value)} items>"
        shown = ", ".join(map(_short, value))
        return f"({shown})" if isinstance(value, tuple) else f"[{shown}]"
    if is_dataclass(value) and type(value).__repr__.__name__ == _NAME:
        return f"<{type(value).__name__}>"
    if isinstance(value, float | np.floating):
        return f"{value:.4g}"
    return repr(value)
