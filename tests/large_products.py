# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Matrix products and factorizations computed by NumPy: slow where it has no BLAS, as in Blender's builds.

Imports neither the project nor pytest, because sessions of an installed extension use it, too.
"""

from __future__ import annotations

import ctypes
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from unittest.mock import patch

import numpy as np

# Products with more multiplications are large, unless one side is short: with a matrix of three columns, for example,
# BLAS is no faster than a loop.
_MULTIPLICATIONS = 100_000
_SIDE = 8
# Factorizations of larger matrices are large.
_FACTORIZED = 40

# Slot of the operator @ in CPython's types: PyTypeObject.tp_as_number, PyNumberMethods.nb_matrix_multiply.
_AS_NUMBER, _MATRIX_MULTIPLY = 12, 34
_BINARY = ctypes.PYFUNCTYPE(ctypes.py_object, ctypes.py_object, ctypes.py_object)

_FACTORIZATIONS = ("cholesky", "det", "eig", "eigh", "eigvals", "eigvalsh", "inv", "lstsq", "pinv", "solve", "svd")


@contextmanager
def noted_products() -> Iterator[list[str]]:
    """Record every large product that NumPy computes, and where.

    Yields
    ------
    list of str
        Grows during the work: the operation and the line of the package that called it.
    """
    noted: list[str] = []

    def note(what: str, *shapes: tuple[int, ...]) -> None:
        noted.append(f"{what} of {' and '.join(map(str, shapes))} in {_place()}")

    def note_product(left: object, right: object, *_others: object, **_options: object) -> None:
        shapes = [np.shape(one) for one in (left, right) if isinstance(one, np.ndarray)]
        if len(shapes) == 2 and is_large_product(*shapes):
            note("a product", *shapes)

    with ExitStack() as stack:
        for name in ("matmul", "dot", "inner"):
            stack.enter_context(patch.object(np, name, _before(getattr(np, name), note_product)))
        for name in ("tensordot", "einsum"):
            stack.enter_context(patch.object(np, name, _before(getattr(np, name), _folding(note, name))))
        for name in _FACTORIZATIONS:
            found = getattr(np.linalg, name)
            stack.enter_context(patch.object(np.linalg, name, _before(found, _factorizing(note, name))))
        stack.enter_context(_operator_noted(note_product))
        yield noted


def is_large_product(left: tuple[int, ...], right: tuple[int, ...]) -> bool:
    """Tell whether a product of arrays with these shapes should use BLAS."""
    if len(left) < 2 or len(right) < 2:
        return False
    rows, inner, columns = left[-2], left[-1], right[-1]
    stack = max(int(np.prod(left[:-2])), int(np.prod(right[:-2])))
    return min(rows, inner, columns) >= _SIDE and stack * rows * inner * columns >= _MULTIPLICATIONS


def _before(function: Callable, note: Callable) -> Callable:
    def noting(*arguments: object, **options: object) -> object:
        note(*arguments, **options)
        return function(*arguments, **options)

    return noting


def _folding(note: Callable, name: str) -> Callable:
    def noting(*arguments: object, optimize: object = False, **_options: object) -> None:
        # Without optimization, einsum never uses BLAS.
        shapes = [np.shape(one) for one in arguments if isinstance(one, np.ndarray)]
        is_product = name == "tensordot" or bool(optimize)
        if is_product and len(shapes) == 2 and all(min(shape, default=0) >= _SIDE for shape in shapes):
            note(name, *shapes)

    return noting


def _factorizing(note: Callable, name: str) -> Callable:
    def noting(matrix: object, *_others: object, **_options: object) -> None:
        shape = np.shape(matrix)
        if len(shape) >= 2 and min(shape[-2:]) >= _FACTORIZED:
            note(f"numpy.linalg.{name}", shape)

    return noting


@contextmanager
def _operator_noted(note: Callable[[object, object], None]) -> Iterator[None]:
    """Record every ``array @ array``, which calls no Python function of NumPy."""
    slots = ctypes.cast(id(np.ndarray), ctypes.POINTER(ctypes.c_void_p))[_AS_NUMBER]
    numbers = ctypes.cast(slots, ctypes.POINTER(ctypes.c_void_p))
    address = numbers[_MATRIX_MULTIPLY]
    multiply = _BINARY(address)

    def noting(left: object, right: object) -> object:
        note(left, right)
        return multiply(left, right)

    kept = _BINARY(noting)
    numbers[_MATRIX_MULTIPLY] = ctypes.cast(kept, ctypes.c_void_p).value
    try:
        yield
    finally:
        numbers[_MATRIX_MULTIPLY] = address


def _place() -> str:
    own = [frame for frame in traceback.extract_stack(sys._getframe(1)) if "convwass_addon" in frame.filename]
    return f"{own[-1].filename.partition('convwass_addon')[2]}:{own[-1].lineno}" if own else "no file of the package"
