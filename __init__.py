# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender looks for the add-on beside its manifest; it lives in ``convwass_addon``."""

if __package__:
    from .convwass_addon import register as register, unregister as unregister
