# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of morphs: an animation, a contact sheet, and previews of assets."""
