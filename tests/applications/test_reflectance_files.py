# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of lobe tables and measured materials, valid and damaged."""

from __future__ import annotations

import struct
import zipfile

import numpy as np
import pytest

from convwass_addon.applications.reflectance.lobe_table import LobeTable, incoming_directions, tabulated
from convwass_addon.applications.reflectance.materials import Ggx
from convwass_addon.applications.reflectance.merl import MerlMaterial, read_merl
from convwass_addon.applications.reflectance.table_files import read_table, write_table
from convwass_addon.errors import ConvwassError, InputError


@pytest.fixture
def table():
    return tabulated(Ggx(0.4, 0.2, (0.9, 0.5, 0.1)), incoming_directions(3, 2), 8)


def test_tables_can_be_written_and_read(table, tmp_path):
    path = tmp_path / "lobes.npz"
    write_table(path, table)
    back = read_table(path)
    assert back.fits(table) and np.array_equal(back.albedo, table.albedo)
    assert np.abs(back.lobes - table.lobes).max() < 1e-6 * table.lobes.max()
    assert [own.name for own in tmp_path.iterdir()] == ["lobes.npz"]


def spoiled(table, **changes):
    arrays = {name: getattr(table, name) for name in ("theta_in", "phi_in", "lobes", "albedo")}
    return {name: own for name, own in (arrays | changes).items() if own is not None}


@pytest.mark.parametrize(
    "change",
    [
        lambda t: {"lobes": None},
        lambda t: {"lobes": t.lobes[:, :, :-4]},
        lambda t: {"lobes": 2 * t.lobes},
        lambda t: {"lobes": -t.lobes},
        lambda t: {"albedo": np.full((6, 3), np.nan)},
        lambda t: {"albedo": t.albedo[:2]},
        lambda t: {"theta_in": t.theta_in + 1},
        lambda t: {"phi_in": 0 * t.phi_in},
        lambda t: {"theta_in": t.theta_in.astype(object)},
        lambda t: {"theta_in": t.theta_in.astype(complex)},
    ],
)
def test_bad_tables_are_refused(table, tmp_path, change):
    path = tmp_path / "bad.npz"
    np.savez(path, **spoiled(table, **change(table)))
    with pytest.raises(InputError, match=r"bad\.npz"):
        read_table(path)


def test_files_that_are_no_tables_are_refused(table, tmp_path):
    path = tmp_path / "bad.npz"
    write_table(path, table)
    content = path.read_bytes()
    for wrong in (b"", b"hello", content[: len(content) // 2], content[:400] + bytes(200) + content[600:]):
        path.write_bytes(wrong)
        with pytest.raises(InputError, match=r"bad\.npz"):
            read_table(path)
    with pytest.raises(InputError, match="cannot be read"):
        read_table(tmp_path / "missing.npz")


def test_headers_that_announce_too_much_data_are_refused(table, tmp_path):
    path = tmp_path / "bad.npz"
    np.savez(path, **spoiled(table))
    header = b"{'descr': '<f8', 'fortran_order': False, 'shape': (99999999, 99999999), }\n"
    with zipfile.ZipFile(path) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    members["lobes.npy"] = b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    with pytest.raises(InputError, match="not a table of lobes"):
        read_table(path)


def test_tables_that_cannot_be_written_leave_nothing(table, tmp_path):
    with pytest.raises(ConvwassError, match="could not be written"):
        write_table(tmp_path / "missing" / "lobes.npz", table)
    assert not list(tmp_path.iterdir())


def merl_values(material):
    """Values at the centers of all bins, as stored in the database, (3, 90, 90, 180)."""
    theta_h = ((np.arange(90) + 0.5) / 90)[:, None] ** 2 * np.pi / 2
    theta_d = (np.arange(90) + 0.5)[None] / 90 * np.pi / 2
    zeros = np.zeros((90, 90))
    # D does not depend on the azimuth, so light perpendicular to the half vector represents all.
    light = np.stack(
        [np.sin(theta_h) * np.cos(theta_d), zeros + np.sin(theta_d), np.cos(theta_h) * np.cos(theta_d)], -1
    )
    found = np.array([[material.reflectance(v, v * [1, -1, 1]) for v in row] for row in light])
    found = np.repeat(found[:, :, None], 180, axis=2)
    return np.moveaxis(found, -1, 0) / (np.array([1.0, 1.15, 1.66]) / 1500.0)[:, None, None, None]


def write_merl(path, values, dimensions=(90, 90, 180)):
    path.write_bytes(struct.pack("<3i", *dimensions) + np.ascontiguousarray(values, "<f8").tobytes())


def test_merl_files_are_read(tmp_path):
    path = tmp_path / "metal.binary"
    material = Ggx(0.4, 0.4, (0.9, 0.5, 0.1))
    write_merl(path, merl_values(material))
    found = tabulated(read_merl(path), incoming_directions(3, 1), 16)
    expected = tabulated(material, incoming_directions(3, 1), 16)
    for index in range(2):
        off = 0.5 * (np.abs(found.lobes[index] - expected.lobes[index]) * found.cells).sum()
        assert off < 0.05
    assert found.albedo[:2] == pytest.approx(expected.albedo[:2], rel=0.06)


def test_merl_bins_are_those_of_the_database():
    values = np.zeros((90, 90, 180, 3), np.float32)
    # Half vector 9 degrees from the normal: row 90 sqrt(9 / 90). Light 30 degrees from it, rotated by 60 degrees.
    values[28, 30, 120] = 1.0
    half, theta_d, phi_d = np.radians(9.0), np.radians(30.3), np.radians(120.5)
    x, y, z = np.sin(theta_d) * np.cos(phi_d), np.sin(theta_d) * np.sin(phi_d), np.cos(theta_d)
    cosine, sine = np.cos(half), np.sin(half)
    light = np.array([cosine * x + sine * z, y, cosine * z - sine * x])
    normal = np.array([sine, 0, cosine])
    view = 2 * (light @ normal) * normal - light
    material = MerlMaterial(values)
    turn = np.array([[0.6, -0.8, 0], [0.8, 0.6, 0], [0, 0, 1]])
    for a, b in ((light, view), (view, light), (turn @ light, turn @ view)):
        assert material.reflectance(a, b[None])[0] == pytest.approx([1, 1, 1])
    assert not material.reflectance(light, (view * [1, -1, 1])[None]).any()


@pytest.mark.parametrize("kind", ["short", "long", "header", "nan", "huge", "empty", "missing"])
def test_bad_merl_files_are_refused(tmp_path, kind):
    path = tmp_path / "bad.binary"
    values = np.ones((3, 90, 90, 180))
    if kind == "nan":
        values[0, 0, 0, 0] = np.nan
    elif kind == "huge":
        values[0, 0, 0, 0] = 1e30
    elif kind == "empty":
        values = -values
    if kind != "missing":
        write_merl(path, values, (90, 180, 90) if kind == "header" else (90, 90, 180))
    if kind == "short":
        path.write_bytes(path.read_bytes()[:-8])
    elif kind == "long":
        path.write_bytes(path.read_bytes() + bytes(8))
    with pytest.raises(InputError, match=r"bad\.binary"):
        read_merl(path)


def test_nothing_reflected_is_matte_and_black():
    black = MerlMaterial(np.zeros((90, 90, 180, 3), np.float32))
    found: LobeTable = tabulated(black, incoming_directions(2, 1), 8)
    assert not found.albedo.any() and (found.lobes * found.cells).sum(axis=(1, 2)) == pytest.approx([1, 1])
