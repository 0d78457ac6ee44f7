# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that show a morph at the value or place that the user sets: players and pads."""
