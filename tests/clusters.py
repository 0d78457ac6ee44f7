# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Dask clusters on this machine, for tests."""

from __future__ import annotations

import gc
import multiprocessing
import sys

import pytest

_ATTEMPTS = 3
# Libraries that take a worker longer to import than its runs take.
_PRELOADED = [
    "distributed",
    "scipy.ndimage",
    "scipy.optimize",
    "scipy.sparse.linalg",
    "scipy.spatial",
    "skimage.measure",
]


def local_cluster(**options):
    """Start a cluster; try again if the machine is too busy for Dask's limit of ten seconds."""
    distributed = pytest.importorskip("distributed")
    if sys.platform == "linux":
        _fork_workers(distributed)
    # A client that could not connect closes when it is collected. If that happens while Dask starts a cluster, both
    # wait for one lock forever.
    gc.collect()
    options = {"host": "127.0.0.1", "dashboard_address": "127.0.0.1:0", **options}
    for _ in range(_ATTEMPTS - 1):
        try:
            return distributed.LocalCluster(**options)
        except (AssertionError, OSError, RuntimeError):
            continue
    return distributed.LocalCluster(**options)


def _fork_workers(distributed):
    """Let workers begin with all libraries; they import this project themselves."""
    import dask

    dask.config.set({"distributed.worker.multiprocessing-method": "forkserver"})
    distributed.utils.get_mp_context()  # which has its own list of modules, the first time
    multiprocessing.get_context("forkserver").set_forkserver_preload(_PRELOADED)
