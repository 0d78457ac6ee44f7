# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Drafts: a file is written completely, or it is unchanged."""

from __future__ import annotations

import os
import threading
from concurrent.futures import ThreadPoolExecutor

import pytest

from convwass_addon.drafts import DraftFiles, draft_of, new_draft, written_together, written_whole
from convwass_addon.errors import ConvwassError


def test_a_draft_replaces_its_file(tmp_path):
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
def test_failures_are_reported(tmp_path, error):
    file = tmp_path / "a.txt"
    file.write_text("old")
    with pytest.raises(ConvwassError, match=f"a.txt could not be written: {error}"), written_whole(file) as draft:
        draft.write_text("half")
        raise error
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]
    assert file.read_text() == "old"


def test_errors_name_the_file_and_not_its_draft(tmp_path):
    file = tmp_path / "missing" / "a.txt"
    with pytest.raises(FileNotFoundError) as caught, draft_of(file) as draft:
        draft.write_text("new")
    assert caught.value.filename == str(file)
    with pytest.raises(FileNotFoundError) as caught, draft_of(tmp_path / "a.txt"):
        (tmp_path / "b.txt").read_text()
    assert caught.value.filename == str(tmp_path / "b.txt")


def test_a_draft_has_no_draft_of_its_own(tmp_path):
    file = tmp_path / "a.txt"
    file.write_text("old")
    drafts = DraftFiles()
    given = drafts.draft_of(file)
    with written_whole(given) as draft:
        assert draft == given
        draft.write_text("new")
        assert len(list(tmp_path.iterdir())) == 2
    assert file.read_text() == "old" and given.read_text() == "new"
    drafts.keep()
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]
    assert file.read_text() == "new"


def test_an_unfinished_draft_is_removed_with_the_others(tmp_path):
    drafts = DraftFiles()
    given = drafts.draft_of(tmp_path / "a.txt")
    with pytest.raises(ConvwassError, match="disk full"), written_whole(given) as draft:
        draft.write_text("half")
        raise OSError("disk full")
    drafts.discard()
    assert not list(tmp_path.iterdir())


def two_drafts(folder):
    """Begin to replace a.txt and to add b.txt."""
    (folder / "a.txt").write_text("old")
    drafts = DraftFiles()
    for name in ("a.txt", "b.txt"):
        drafts.draft_of(folder / name).write_text("new")
    return drafts


def only_one_name(*_args, **_options):
    raise PermissionError("This file system has no links.")


@pytest.mark.parametrize(("has_links", "failing"), [(True, 1), (True, 2), (False, 1), (False, 2), (False, 3)])
@pytest.mark.parametrize("error", [PermissionError("in use"), KeyboardInterrupt()])
def test_files_are_as_before_if_one_cannot_be_moved(tmp_path, monkeypatch, has_links, failing, error):
    """a.txt is replaced, after it was moved aside without links, and then b.txt is moved."""
    drafts, replace, calls = two_drafts(tmp_path), os.replace, []

    def move(source, target):
        calls.append(target)
        if len(calls) == failing:
            raise error
        replace(source, target)

    monkeypatch.setattr(os, "replace", move)
    if not has_links:
        monkeypatch.setattr(os, "link", only_one_name)
    expected = KeyboardInterrupt if isinstance(error, KeyboardInterrupt) else ConvwassError
    with pytest.raises(expected):
        drafts.keep()
    drafts.discard()
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {"a.txt": "old"}


def test_files_are_written_together_or_not_at_all(tmp_path):
    (tmp_path / "a.txt").write_text("old")
    with pytest.raises(ZeroDivisionError), written_together() as drafts:
        with drafts.written(tmp_path / "a.txt") as draft:
            draft.write_text("new")
        assert (tmp_path / "a.txt").read_text() == "old"
        raise ZeroDivisionError
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {"a.txt": "old"}
    with written_together() as drafts:
        for name in ("a.txt", "b.txt"):
            with drafts.written(tmp_path / name) as draft:
                draft.write_text("new")
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {"a.txt": "new", "b.txt": "new"}


def test_an_error_of_a_draft_names_its_file(tmp_path):
    with (
        pytest.raises(ConvwassError, match=r"a\.txt could not be written: disk full"),
        written_together() as drafts,
        drafts.written(tmp_path / "a.txt") as draft,
    ):
        draft.write_text("half")
        raise OSError("disk full")
    assert not list(tmp_path.iterdir())


def test_two_jobs_may_create_one_folder_at_the_same_time(tmp_path):
    """In 50 attempts of eight threads each, some find the folder missing that another one is just creating."""
    with ThreadPoolExecutor(8) as pool:
        for number in range(50):
            together = threading.Barrier(8)

            def drafted(_job, target=tmp_path / str(number) / "sky.exr", together=together):
                together.wait()
                return DraftFiles().draft_of(target).parent

            assert set(pool.map(drafted, range(8))) == {tmp_path / str(number)}


def test_other_errors_are_passed_on(tmp_path):
    with pytest.raises(ZeroDivisionError), written_whole(tmp_path / "a.txt") as draft:
        draft.write_text("half")
        raise ZeroDivisionError
    assert not list(tmp_path.iterdir())
    with pytest.raises(FileNotFoundError), draft_of(tmp_path / "a.txt"):
        pass
    with pytest.raises(ConvwassError, match="could not be written"), written_whole(tmp_path / "a.txt"):
        pass


def test_abandoned_drafts_are_removed_after_a_day(tmp_path):
    old, young = (new_draft(tmp_path / name) for name in ("a.txt", "b.txt"))
    folder = new_draft(tmp_path / "c.obj", "")
    others = [tmp_path / name for name in (".convwass-notes", ".hidden.txt", "convwass-0123456789abcdef.txt")]
    folder.mkdir()
    (folder / "c.obj").write_text("half")
    # Blender was killed while it wrote this one.
    saved = new_draft(tmp_path / "f.blend@")
    for path in (old, young, saved, *others):
        path.write_text("half")
    for path in (old, folder, saved, *others):
        os.utime(path, (0, 0))
    aside = tmp_path / "aside"
    aside.mkdir()
    (aside / "kept").write_text("whole")
    link = new_draft(tmp_path / "d", "")
    link.symlink_to(aside)
    os.utime(link, (0, 0), follow_symlinks=False)
    # Each folder is searched once; under its new name, this one has not been searched yet.
    later = tmp_path.rename(tmp_path.with_name("later"))
    new_draft(later / "e.txt")
    assert sorted(path.name for path in later.iterdir()) == sorted([young.name, "aside", *(p.name for p in others)])
    assert (later / "aside" / "kept").read_text() == "whole"


def test_an_unreadable_folder_is_tolerated(tmp_path):
    assert new_draft(tmp_path / "none" / "a.txt").parent == tmp_path / "none"
