# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Analytic materials: reflectance by formula."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError

# Below this roughness Blender's Principled BSDF is a mirror, which no cell of a table could resolve.
_LEAST_ALPHA = 1e-3
# Full roughness and anisotropy of the Principled BSDF are alphas of 3.2 and 0.32.
_MOST_ALPHA = 4
_MOST_EXPONENT = 1e6
# Fraction of the aspect ratio that full anisotropy removes, as in the Principled BSDF.
_ASPECT = 0.9

Color = tuple[float, float, float]
WHITE: Color = (1.0, 1.0, 1.0)


class Material(Protocol):
    """A material that can be tabulated.

    Attributes
    ----------
    is_isotropic : bool
        Whether rotating the surface around its normal changes nothing.
    """

    is_isotropic: bool

    def reflectance(self, incoming: NDArray[np.float64], outgoing: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return f in 1/sr for light from `incoming`, (3,), to `outgoing`, (..., 3): unit vectors above the surface.

        The normal is +Z, the tangent +X. The result is (..., 3), one value per channel.
        """


@dataclass(frozen=True)
class Ggx:
    """The microfacet model of Walter et al. 2007 with Smith masking: a Glossy BSDF or a metallic Principled BSDF.

    Attributes
    ----------
    alpha_x, alpha_y : float
        Roughness along and across the tangent; the square of Blender's roughness.
    color : (3,) float
        Color of the reflected light, the same for all angles.
    """

    alpha_x: float
    alpha_y: float
    color: Color = WHITE

    def __post_init__(self) -> None:
        """Refuse an invalid alpha or color.

        Raises
        ------
        InputError
            An alpha is not positive or too large, or the color is invalid.
        """
        if not all(np.isfinite(alpha) and 0 < alpha <= _MOST_ALPHA for alpha in (self.alpha_x, self.alpha_y)):
            raise InputError("The alpha of a GGX material must be a positive number, {most} at most.", most=_MOST_ALPHA)
        _check_color(self.color)

    @classmethod
    def principled(cls, roughness: float, anisotropic: float = 0.0, color: Color = WHITE) -> Ggx:
        """Create a material from values of Blender's Principled BSDF.

        Raises
        ------
        InputError
            Roughness or anisotropy outside 0 to 1.
        """
        if not 0 <= roughness <= 1:
            raise InputError("The roughness of a material must lie between 0 and 1.")
        if not 0 <= anisotropic <= 1:
            raise InputError("The anisotropy of a material must lie between 0 and 1.")
        aspect = np.sqrt(1.0 - _ASPECT * anisotropic)
        alphas = [max(float(roughness**2 * part), _LEAST_ALPHA) for part in (1.0 / aspect, aspect)]
        return cls(*alphas, color)

    @property
    def roughness(self) -> float:
        """Corresponding roughness of the Principled BSDF."""
        return float((self.alpha_x * self.alpha_y) ** 0.25)

    @property
    def anisotropic(self) -> float:
        """Corresponding anisotropy, clipped to the range of the Principled BSDF."""
        aspect = min(self.alpha_x, self.alpha_y) / max(self.alpha_x, self.alpha_y)
        return float(min((1.0 - aspect) / _ASPECT, 1.0))

    @property
    def rotation(self) -> float:
        """Corresponding Anisotropic Rotation: a quarter turn if the surface is smoother along the tangent."""
        return 0.25 if self.alpha_x < self.alpha_y else 0.0

    @property
    def is_isotropic(self) -> bool:
        """Whether the roughness is equal along and across the tangent."""
        return self.alpha_x == self.alpha_y

    def reflectance(self, incoming: NDArray[np.float64], outgoing: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return D G / (4 cos cos), with height-correlated masking and shadowing (Heitz 2014)."""
        half = half_vectors(incoming, outgoing)
        slopes = (half[..., 0] / self.alpha_x) ** 2 + (half[..., 1] / self.alpha_y) ** 2
        facets = 1.0 / (np.pi * self.alpha_x * self.alpha_y * (slopes + half[..., 2] ** 2) ** 2)
        masking = 1.0 / (1.0 + self._masked(incoming) + self._masked(outgoing))
        cosines = np.maximum(incoming[2] * outgoing[..., 2], 1e-12)
        return (facets * masking / (4.0 * cosines))[..., None] * np.asarray(self.color)

    def _masked(self, direction: NDArray[np.float64]) -> NDArray[np.float64]:
        across = (self.alpha_x * direction[..., 0]) ** 2 + (self.alpha_y * direction[..., 1]) ** 2
        tangents = across / np.maximum(direction[..., 2] ** 2, 1e-24)
        return 0.5 * (np.sqrt(1.0 + tangents) - 1.0)


@dataclass(frozen=True)
class BlinnPhong:
    """The highlight of Blinn 1977: a power of the cosine of the half vector.

    Attributes
    ----------
    exponent : float
        The larger, the smaller the highlight.
    color : (3,) float
        Color of the reflected light.
    """

    exponent: float
    color: Color = WHITE
    is_isotropic = True

    def __post_init__(self) -> None:
        """Refuse an invalid exponent."""
        _check_exponent(self.exponent)
        _check_color(self.color)

    def reflectance(self, incoming: NDArray[np.float64], outgoing: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return (n + 2) / (8 pi) (N H)^n, with the usual approximate normalization."""
        lobe = half_vectors(incoming, outgoing)[..., 2] ** self.exponent
        return ((self.exponent + 2.0) / (8.0 * np.pi) * lobe)[..., None] * np.asarray(self.color)


@dataclass(frozen=True)
class AshikhminShirley:
    """The specular part of the anisotropic Phong model of Ashikhmin and Shirley 2000.

    Attributes
    ----------
    exponent_u, exponent_v : float
        Along and across the tangent.
    color : (3,) float
        Reflectance at normal incidence; it tends to white at grazing angles (Schlick's formula).
    """

    exponent_u: float
    exponent_v: float
    color: Color = WHITE

    def __post_init__(self) -> None:
        """Refuse invalid exponents."""
        _check_exponent(self.exponent_u)
        _check_exponent(self.exponent_v)
        _check_color(self.color)

    @property
    def is_isotropic(self) -> bool:
        """Whether both exponents are equal."""
        return self.exponent_u == self.exponent_v

    def reflectance(self, incoming: NDArray[np.float64], outgoing: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return equation 4 of the paper with Schlick's Fresnel term."""
        half = half_vectors(incoming, outgoing)
        aslant = np.maximum(1.0 - half[..., 2] ** 2, 1e-24)
        power = (self.exponent_u * half[..., 0] ** 2 + self.exponent_v * half[..., 1] ** 2) / aslant
        size = np.sqrt((self.exponent_u + 1.0) * (self.exponent_v + 1.0)) / (8.0 * np.pi)
        to_half = np.clip((half * incoming).sum(axis=-1), 1e-12, 1.0)
        lobe = size * half[..., 2] ** power / (to_half * np.maximum(incoming[2], outgoing[..., 2]))
        color = np.asarray(self.color)
        return lobe[..., None] * (color + (1.0 - color) * ((1.0 - to_half) ** 5)[..., None])


def half_vectors(incoming: NDArray[np.float64], outgoing: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return unit vectors halfway between directions."""
    total = incoming + outgoing
    return total / np.maximum(np.linalg.norm(total, axis=-1, keepdims=True), 1e-12)


def _check_exponent(exponent: float) -> None:
    if not (np.isfinite(exponent) and 0 < exponent <= _MOST_EXPONENT):
        raise InputError("The exponent of a material must be a positive number, {most} at most.", most=_MOST_EXPONENT)


def _check_color(color: Color) -> None:
    if len(color) != 3 or not all(np.isfinite(part) and 0 <= part <= 1 for part in color):
        raise InputError("The color of a material must be three numbers between 0 and 1.")
