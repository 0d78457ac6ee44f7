# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Transfer palettes between images; write the results as pictures, lookup tables and compositor groups."""
