# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What frames of morphs carry and show of the materials and attributes of the inputs."""
