# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How fast and how large: run by `run.py bench`, never by the tests."""
