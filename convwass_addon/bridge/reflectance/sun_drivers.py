# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Let the light of a node group follow a sun, by drivers, and keep what the user changes."""

from __future__ import annotations

from collections.abc import Container

import bpy

from ..keyframes import curves_of
from .lobe_nodes import DIRECTION, LIGHT, STRENGTH

_LIGHT_AS_LEFT = "convwass_light"
"""Custom property of a node: the numbers of its light that no driver sets, as they were before the user changed any."""

# Inputs that follow a sun, and their numbers; -1 stands for an input that is a number itself.
_OF_SUN = {DIRECTION: (0, 1, 2), STRENGTH: (-1,), LIGHT: (0, 1, 2)}
# A lamp shines along its Z axis, expressed by its quaternion; Blender evaluates such expressions without Python.
_Z_AXIS = ("2*(x*z+w*y)", "2*(y*z-w*x)", "1-2*(x*x+y*y)")


def follow(node: bpy.types.Node, sun: bpy.types.Object | None) -> None:
    """Drive the direction, color and strength of a node by a sun; without one, no longer by the last one.

    Numbers that the user has changed, keyed or driven stay.
    """
    for socket, index in _light_of(node):
        curve = _driver_of(socket, index)
        if curve is not None and _is_of_sun(curve, socket):
            _leave(socket, index)
            node.id_data.animation_data.drivers.remove(curve)
        elif curve is not None or not _is_as_left(socket):
            continue
        if sun is not None:
            _drive(socket, index, sun)


def _light_of(node: bpy.types.Node) -> list[tuple[bpy.types.NodeSocket, int]]:
    """Return the inputs that follow a sun, once for each of their numbers."""
    return [(node.inputs[name], index) for name, own in _OF_SUN.items() if name in node.inputs for index in own]


def followed_light(node: bpy.types.Node) -> set[tuple[str, int]]:
    """Return the numbers of the light that follow a sun, each with the name of its input."""
    curves = {(socket.name, index): (_driver_of(socket, index), socket) for socket, index in _light_of(node)}
    return {place for place, (curve, socket) in curves.items() if curve is not None and _is_of_sun(curve, socket)}


def leave_light(node: bpy.types.Node, numbers: Container[tuple[str, int]] | None = None) -> None:
    """Remember all or some numbers of the light that no driver sets, to tell whether the user changes them."""
    for socket, index in _light_of(node):
        if numbers is None or (socket.name, index) in numbers:
            _leave(socket, index)


def _driver_of(socket: bpy.types.NodeSocket, index: int) -> bpy.types.FCurve | None:
    data = socket.id_data.animation_data
    return data and data.drivers.find(socket.path_from_id("default_value"), index=max(index, 0))


def _is_of_sun(curve: bpy.types.FCurve, socket: bpy.types.NodeSocket) -> bool:
    """Return whether a driver is as `_drive` makes them."""
    driver, index = curve.driver, curve.array_index
    if curve.mute or not len(driver.variables):
        return False
    if socket.name == DIRECTION:
        return driver.expression == _Z_AXIS[index] and all(own.type == "TRANSFORMS" for own in driver.variables)
    variable = driver.variables[0]
    return (
        len(driver.variables) == 1
        and (driver.type, variable.type) == ("AVERAGE", "SINGLE_PROP")
        and variable.targets[0].data_path == _sun_path(socket, index)
    )


def _leave(socket: bpy.types.NodeSocket, index: int) -> None:
    """Remember a number of the light."""
    node = socket.node
    if _LIGHT_AS_LEFT not in node:
        node[_LIGHT_AS_LEFT] = {}
    node[_LIGHT_AS_LEFT][f"{socket.name} {index}"] = _number(socket, index)


def _is_as_left(socket: bpy.types.NodeSocket) -> bool:
    """Return whether the user has changed no number of an input."""
    path, left = socket.path_from_id("default_value"), socket.node.get(_LIGHT_AS_LEFT, {})
    if curves_of(socket.id_data, path):
        return False
    for index in _OF_SUN[socket.name]:
        curve = _driver_of(socket, index)
        number = left.get(f"{socket.name} {index}")
        if not (number == _number(socket, index) if curve is None else _is_of_sun(curve, socket)):
            return False
    return True


def _number(socket: bpy.types.NodeSocket, index: int) -> float:
    return socket.default_value if index < 0 else socket.default_value[index]


def _drive(socket: bpy.types.NodeSocket, index: int, sun: bpy.types.Object) -> None:
    """Let a number of the light follow a sun."""
    driver = socket.driver_add("default_value", index).driver
    if socket.name != DIRECTION:
        variable = driver.variables.new()
        variable.type = "SINGLE_PROP"
        variable.targets[0].id, variable.targets[0].data_path = sun, _sun_path(socket, index)
        driver.type = "AVERAGE"
        return
    for letter in "wxyz":
        variable = driver.variables.new()
        variable.name, variable.type = letter, "TRANSFORMS"
        target = variable.targets[0]
        target.id, target.transform_type, target.rotation_mode = sun, f"ROT_{letter.upper()}", "QUATERNION"
    driver.expression = _Z_AXIS[index]


def _sun_path(socket: bpy.types.NodeSocket, index: int) -> str:
    return "data.energy" if socket.name == STRENGTH else f"data.color[{index}]"
