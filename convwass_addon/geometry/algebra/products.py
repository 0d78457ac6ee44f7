# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Large matrix products with SciPy's BLAS, because the NumPy in Blender may have none."""

from __future__ import annotations

import ctypes
import re
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import blas, cython_blas

# C signature of dgemm and sgemm as exported by SciPy, with its own name for the floating-point type.
_SIGNATURE = rb"void \(char \*, char \*, int \*, int \*, int \*, N, N, int \*, N, int \*, N, N, int \*\)"
_NUMBER = rb"__pyx_t_\w+_[ds] \*"
_BYTES = 8
# Matrices with fewer rows are multiplied at once, others in blocks of so many columns. A product with a Gaussian whose
# entries end at 45 cells takes 0.9 of the time with 225 rows, and 0.55 with 450.
_LONG, _COLUMNS = 200, 96


def product(left: NDArray[np.float64], right: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return left @ right.

    Parameters
    ----------
    left : (n, k) float64
        Not copied if in C order.
    right : (k, m) float64
        Not copied if in C order.

    Returns
    -------
    (n, m) float64
        In C order.
    """
    # Compute the transposed product of the transposed arrays, which copies nothing in C order.
    return blas.dgemm(1.0, np.ascontiguousarray(right).T, np.ascontiguousarray(left).T).T


def contract(source: NDArray[np.float64], target: NDArray[np.float64], kernel: NDArray[np.float64]) -> None:
    """Contract the last axis of an array with a matrix and move it to the front, so that the next axis becomes last.

    BLAS writes the transposed order at no extra cost, and other threads can run meanwhile. Of a large banded matrix,
    most zeros are skipped.

    Parameters
    ----------
    source : (lines * size,) float64
        Contiguous: lines of `size` values.
    target : (new size * lines,) float64
        Contiguous; overwritten. For each of the new values, those of all lines.
    kernel : (size, new size) float64
        In Fortran order.
    """
    size = len(kernel)
    lines = source.size // size
    if _dgemm is None:
        _through_wrapper(source, target, kernel)
        return
    for rows, columns in _filled_blocks(kernel):
        # target^T = source^T kernel, all in BLAS's column-major order.
        _dgemm(
            b"T",
            b"N",
            *(ctypes.byref(ctypes.c_int(number)) for number in (lines, _count(columns), _count(rows))),
            ctypes.byref(ctypes.c_double(1.0)),
            source.ctypes.data + _BYTES * rows.start,
            ctypes.byref(ctypes.c_int(size)),
            kernel.ctypes.data + _BYTES * (columns.start * size + rows.start),
            ctypes.byref(ctypes.c_int(size)),
            ctypes.byref(ctypes.c_double(0.0)),
            target.ctypes.data + _BYTES * columns.start * lines,
            ctypes.byref(ctypes.c_int(lines)),
        )


def _filled_blocks(kernel: NDArray[np.float64]) -> list[tuple[slice, slice]]:
    """Divide the columns of a matrix into blocks; return the rows between which each is not zero, and its columns.

    A matrix that is small, or not banded, is a single block.
    """
    size, new_size = kernel.shape
    whole = [(slice(0, size), slice(0, new_size))]
    if size < _LONG:
        return whole
    found = []
    for start in range(0, new_size, _COLUMNS):
        columns = slice(start, min(start + _COLUMNS, new_size))
        filled = np.flatnonzero(kernel[:, columns].any(axis=1))
        # A product with a single row of zeros is zero.
        rows = slice(int(filled[0]), int(filled[-1]) + 1) if len(filled) else slice(0, 1)
        found.append((rows, columns))
    return found if any(_count(rows) < size for rows, _ in found) else whole


def _count(span: slice) -> int:
    return span.stop - span.start


def _through_wrapper(source: NDArray[np.float64], target: NDArray[np.float64], kernel: NDArray[np.float64]) -> None:
    """Fallback through SciPy's Python wrapper, which holds the GIL."""
    size, new_size = kernel.shape
    lines = source.reshape(-1, size)
    blas.dgemm(1.0, lines.T, kernel, trans_a=1, c=target.reshape(new_size, -1).T, overwrite_c=1)


def multiply(rows: NDArray[np.float32], matrix: NDArray[np.float32], out: NDArray[np.float32]) -> None:
    """Write `rows @ matrix` to `out` in single precision; other threads can run meanwhile.

    Parameters
    ----------
    rows : (k, n) float32
        C-contiguous.
    matrix : (n, m) float32
        C-contiguous.
    out : (k, m) float32
        C-contiguous; overwritten.

    Raises
    ------
    ValueError
        Wrong type, order or size: C code would read out of bounds, or a transposed matrix.
    """
    count, size = rows.shape
    new_size = matrix.shape[1]
    if matrix.shape != (size, new_size) or out.shape != (count, new_size):
        raise ValueError(f"{rows.shape} times {matrix.shape} does not give {out.shape}")
    if any(array.dtype != np.float32 or not array.flags.c_contiguous for array in (rows, matrix, out)):
        raise ValueError("rows, matrix and out must be float32 in C order")
    if _sgemm is None:
        blas.sgemm(1.0, matrix.T, rows.T, c=out.T, overwrite_c=1)
        return
    # out^T = matrix^T rows^T, all in BLAS's column-major order.
    _sgemm(
        b"N",
        b"N",
        *(ctypes.byref(ctypes.c_int(number)) for number in (new_size, count, size)),
        ctypes.byref(ctypes.c_float(1.0)),
        matrix.ctypes.data,
        ctypes.byref(ctypes.c_int(new_size)),
        rows.ctypes.data,
        ctypes.byref(ctypes.c_int(size)),
        ctypes.byref(ctypes.c_float(0.0)),
        out.ctypes.data,
        ctypes.byref(ctypes.c_int(new_size)),
    )


def _address_of(routine: str) -> Callable[..., None] | None:
    """Return the C function of dgemm or sgemm, or None if SciPy's signature is not the expected one.

    Calls through ctypes release the GIL, so that threads do not wait for each other's products.
    """
    capsule = getattr(cython_blas, "__pyx_capi__", {}).get(routine)
    if capsule is None:
        return None
    name_of = ctypes.pythonapi.PyCapsule_GetName
    name_of.restype, name_of.argtypes = ctypes.c_char_p, [ctypes.py_object]
    name = name_of(capsule)
    if re.fullmatch(_SIGNATURE, re.sub(_NUMBER, b"N", name)) is None:
        return None
    pointer_of = ctypes.pythonapi.PyCapsule_GetPointer
    pointer_of.restype, pointer_of.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_char_p]
    kinds = [ctypes.c_char_p] * 2 + [ctypes.c_void_p] * 11
    return ctypes.CFUNCTYPE(None, *kinds)(pointer_of(capsule, name))


_dgemm = _address_of("dgemm")
_sgemm = _address_of("sgemm")

LETS_OTHERS_WORK = _dgemm is not None and _sgemm is not None
"""Whether other threads can run during products: SciPy exports its C functions with the expected signatures."""
