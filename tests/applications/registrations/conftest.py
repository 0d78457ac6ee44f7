# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of all tests of registrations: those of motions."""

from tests.applications.motions.conftest import few_mirrored_points

__all__ = ["few_mirrored_points"]
