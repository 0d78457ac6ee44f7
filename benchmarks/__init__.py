# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Benchmarks of speed, memory and quality, run by `run.py bench` and never by the tests."""
