# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A separate environment for the programs that the benchmarks compare with."""

from __future__ import annotations

import hashlib
import sys
from pathlib import Path

from .environment import Environment, SetupError, Stamp, _locked, _say

FOLDER = ".venv-peers"
REQUIREMENTS = "benchmarks/peers.txt"
OPTIONAL = "benchmarks/peers-optional.txt"


class PeersEnvironment(Environment):
    """An environment with `REQUIREMENTS`, with `OPTIONAL` if pip finds it, and without the project's dependencies."""

    @classmethod
    def of(cls, project: Path) -> PeersEnvironment:
        """Return the peers' environment of a project folder."""
        return cls(project, project / FOLDER)

    def declared(self) -> str:
        """Hash of all requirements, including the optional ones."""
        both = [(self.project / name).read_bytes() for name in (REQUIREMENTS, OPTIONAL)]
        return hashlib.sha256(b"\0".join(both)).hexdigest()

    def prepare_peers(self) -> None:
        """Create the environment with the running Python unless a valid one exists.

        Raises
        ------
        SetupError
            If it cannot be created; the message is for the user.
        """
        if self.is_installed():
            return
        with _locked(self.folder.with_name(self.folder.name + ".lock"), self.shown):
            if not self.is_installed():
                self._install_peers()

    def _install_peers(self) -> None:
        _say(f"Setting up {self.shown} for the peers. This happens once; it downloads about 450 MB.")
        self._remove()
        self.folder.mkdir(parents=True)
        self._write_stamp(Stamp())
        self._run([sys.executable, "-m", "venv", str(self.folder)], "Making the peers' environment failed.")
        self._run(
            [*self._pip_install(quiet=True), "--requirement", REQUIREMENTS],
            "Installing the peers failed; pip's message is above. The first time it needs a network; the benchmarks "
            "named morph, quality and table1 do without.",
        )
        self._install_optional()
        self._write_stamp(
            Stamp(declared=self.declared(), folder=str(self.folder), distributions=self._installed_records())
        )

    def _install_optional(self) -> None:
        try:
            self._run([*self._pip_install(quiet=True), "--requirement", OPTIONAL], "")
        except SetupError:
            _say(
                f"  Going on without what {OPTIONAL} lists: pip's message is above, and the rows say what is missing. "
                f"To try again, delete {self.shown}."
            )
