# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Other triangles for the same surface: coarser, finer, of better angles."""
