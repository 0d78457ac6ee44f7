# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays in general: chunks, groups and components by label, distinct numbers, quantiles."""
