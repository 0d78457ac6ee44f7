# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Solver settings of morphs."""

from __future__ import annotations

from ..applications.flat.flat_settings import FlatSettings
from ..applications.morphs.morph_settings import MorphSettings
from ..schema import settings_of
from .from_schema import values_of, with_properties

OF_FLAT = ("resolution", "words")
"""Settings of flat shapes that solid shapes do not have."""


@with_properties(FlatSettings, only=OF_FLAT)
@with_properties(MorphSettings)
class SolverProperties:
    """Properties of the solver."""

    def solver_settings(self) -> MorphSettings:
        """Return the settings for solid shapes; raises InputError if they are invalid."""
        return MorphSettings(**values_of(self, MorphSettings))

    def flat_settings(self) -> FlatSettings:
        """Return the settings for flat shapes; raises InputError if they are invalid."""
        return FlatSettings(**values_of(self, FlatSettings) | {"parts": "none"})

    def begin_preset(self) -> None:
        """Reset all properties that a preset sets; shipped presets only contain differences from the defaults."""
        for name in (name for one in settings_of(MorphSettings) if one.preset for name in one.properties):
            setattr(self, name, self.bl_rna.properties[name].default)
