# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Drafts: a file is there as a whole, or as it was before."""

from __future__ import annotations

import pytest

from convwass_addon.drafts import draft_of, written_whole
from convwass_addon.errors import ConvwassError


def test_a_draft_takes_the_place_of_its_file(tmp_path):
    file = tmp_path / "a.TXT"
    file.write_text("old")
    with draft_of(file) as draft:
        assert (draft.parent, draft.suffix) == (tmp_path, ".txt")
        draft.write_text("new")
        assert file.read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["a.TXT"]
    assert file.read_text() == "new"
    with draft_of(file, ".part") as draft:
        assert draft.suffix == ".part"
        draft.write_text("newer")
    assert file.read_text() == "newer"


@pytest.mark.parametrize("error", [RuntimeError("no pixels"), OSError("disk full")])
def test_what_goes_wrong_is_told(tmp_path, error):
    file = tmp_path / "a.txt"
    file.write_text("old")
    with pytest.raises(ConvwassError, match=f"a.txt could not be written: {error}"), written_whole(file) as draft:
        draft.write_text("half")
        raise error
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]
    assert file.read_text() == "old"


def test_other_errors_go_on(tmp_path):
    with pytest.raises(ZeroDivisionError), written_whole(tmp_path / "a.txt") as draft:
        draft.write_text("half")
        raise ZeroDivisionError
    assert not list(tmp_path.iterdir())
    with pytest.raises(FileNotFoundError), draft_of(tmp_path / "a.txt"):
        pass
    with pytest.raises(ConvwassError, match="could not be written"), written_whole(tmp_path / "a.txt"):
        pass
