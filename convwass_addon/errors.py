# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The errors whose message is meant for the person at the keyboard."""

from __future__ import annotations


class ConvwassError(Exception):
    """Something the user can act on; the message says what to do."""


class InputError(ConvwassError):
    """The input cannot be used as it is."""


class ResourceError(ConvwassError):
    """The job asks for more than this machine has."""


class Cancelled(ConvwassError):
    """The user stopped the job; what was finished is kept."""
