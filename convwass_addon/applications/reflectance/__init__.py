# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How materials reflect light: lobes as distributions on the hemisphere, and materials between others."""
