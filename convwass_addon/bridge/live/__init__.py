# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Live morphs in the scene: a shape, a pad with a handle, and the computation behind them."""
