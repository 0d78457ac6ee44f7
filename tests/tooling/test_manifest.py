# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Metadata for Blender and pip is correct and consistent."""

from __future__ import annotations

import re
import tomllib

import pytest
from packaging.requirements import Requirement

from tools import builder, pythons


@pytest.fixture
def manifest(project):
    return tomllib.loads((project / "blender_manifest.toml").read_text(encoding="utf-8"))


@pytest.fixture
def declared(project):
    return tomllib.loads((project / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def test_versions_agree(manifest, declared):
    assert manifest["version"] == declared["version"]
    assert manifest["id"] == declared["name"]


def test_licenses_agree_and_exist(manifest, declared, project):
    assert manifest["license"] == ["SPDX:" + declared["license"]]
    assert "GNU GENERAL PUBLIC LICENSE" in (project / "LICENSE").read_text(encoding="utf-8")


def test_blender_accepts_the_manifest(project):
    builder.validate(project)


def test_a_bad_manifest_is_refused_with_the_reason(project, tmp_path):
    text = (project / "blender_manifest.toml").read_text(encoding="utf-8")
    (tmp_path / "blender_manifest.toml").write_text(text.replace('type = "add-on"', 'type = "addon"'), encoding="utf-8")
    (tmp_path / "__init__.py").touch()
    with pytest.raises(builder.BuilderError, match="type"):
        builder.validate(tmp_path)


def test_every_python_gets_a_compatible_blender(declared):
    blenders = [Requirement(text) for text in declared["optional-dependencies"]["blender"]]
    for version in pythons.WANTED:
        assert sum(blender.marker.evaluate({"python_version": version}) for blender in blenders) == 1


@pytest.mark.parametrize(
    ("system", "machine", "has_wheels"),
    [
        ("linux", "x86_64", True),
        ("win32", "AMD64", True),
        ("darwin", "arm64", True),
        ("darwin", "x86_64", True),
        ("linux", "aarch64", False),
        ("win32", "ARM64", False),
    ],
)
def test_cholespy_is_required_only_where_it_has_wheels(declared, system, machine, has_wheels):
    (cholespy,) = (Requirement(text) for text in declared["dependencies"] if text.startswith("cholespy"))
    assert cholespy.marker.evaluate({"sys_platform": system, "platform_machine": machine}) == has_wheels


def test_wheels_in_the_zip_satisfy_the_requirements(declared, project):
    listed = (project / "tools" / "wheels.txt").read_text(encoding="utf-8")
    bundled = dict(re.findall(r"^([\w-]+)==([\w.]+)", listed, flags=re.MULTILINE))
    requirements = {requirement.name: requirement for requirement in map(Requirement, declared["dependencies"])}
    for name in bundled.keys() - {"lazy-loader"}:  # needed by scikit-image
        assert requirements[name].specifier.contains(bundled[name])
    assert requirements.keys() - bundled.keys() == {"numpy"}  # included in Blender
