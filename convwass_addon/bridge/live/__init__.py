# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A live morph in the scene: a shape, a pad with a handle, and what they are fed by."""
