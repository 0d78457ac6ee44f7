# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Dask clusters on this machine, for tests."""

from __future__ import annotations

import pytest

_ATTEMPTS = 3


def local_cluster(**options):
    """Start a cluster; try again if the machine is too busy for Dask's limit of ten seconds."""
    distributed = pytest.importorskip("distributed")
    options = {"host": "127.0.0.1", "dashboard_address": "127.0.0.1:0", **options}
    for _ in range(_ATTEMPTS - 1):
        try:
            return distributed.LocalCluster(**options)
        except (AssertionError, OSError, RuntimeError):
            continue
    return distributed.LocalCluster(**options)
