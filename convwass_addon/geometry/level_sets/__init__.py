# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Level sets of densities: the surfaces that enclose them, their topology and its repair, and their detail."""
