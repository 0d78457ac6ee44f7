# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Attach parts to a body without an operator."""

from __future__ import annotations

from convwass_addon.bridge.one_mesh.attached_parts import AttachJob
from convwass_addon.progress import drained


def attach_parts(body, parts, *, rigid):
    """Attach parts at once, and return the messages for the user."""
    job = AttachJob(body, parts, rigid=rigid)
    drained(job.steps())
    return job.finish()
