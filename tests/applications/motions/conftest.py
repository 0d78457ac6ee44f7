# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of all tests of motions."""

from __future__ import annotations

import pytest

from convwass_addon.geometry.meshes import mirror_planes


@pytest.fixture(autouse=True, scope="module")
def few_mirrored_points():
    """Look for mirror planes with few points, which are enough for smooth shapes: every map looks for some."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(mirror_planes, "_SAMPLES", 150)
        yield
