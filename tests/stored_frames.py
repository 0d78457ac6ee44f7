# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compare frames that were read from files, which are rounded, with frames as they were computed."""

from __future__ import annotations

import numpy as np

# Half of the largest steps, relative to the size of the frame, and a little for single precision.
_VERTICES, _ORIGINS, _TANGENTS = 2.0**-17, 1.01 * 2.0**-15, 1.01 * 2.0**-12


def assert_as_stored(found, expected):
    """Check that a frame is the same, up to the rounding of files."""
    assert (found.mesh is None) == (expected.mesh is None)
    if expected.mesh is None:
        return
    np.testing.assert_array_equal(found.mesh.faces, expected.mesh.faces)
    size = np.ptp(expected.mesh.vertices, axis=0).max()
    np.testing.assert_allclose(found.mesh.vertices, expected.mesh.vertices, rtol=0, atol=size * _VERTICES)
    for name, share in (("origins", _ORIGINS), ("tangents", _TANGENTS)):
        own, other = getattr(found, name), getattr(expected, name)
        assert (own is None) == (other is None)
        if own is not None:
            np.testing.assert_allclose(own, other, rtol=0, atol=size * share)
