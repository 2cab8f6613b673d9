"""What RGB means."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _upglow
from ._illuminant import Illuminant


class Contract:
    """What must be agreed before RGB means a color. The observer is CIE 1931 2°.

    Parameters
    ----------
    space
        ``acescg``, ``aces2065-1``, ``rec2020``, ``p3-d65``, ``srgb``, ``prophoto``, ``adobe-rgb``,
        ``xyz``, or eight numbers: CIE 1931 chromaticities x, y of red, green, blue and white.
    illuminant
        The light that materials are seen under: an `Illuminant`, or what one is made from.
    adaptation
        ``bradford``: RGB (1, 1, 1) is the perfect diffuser under the light. ``none``: the space's
        own matrix; R = G = B is then not a flat spectrum unless the whites agree.

    Raises
    ------
    ValueError
        If a name is unknown or the numbers make no space.

    Examples
    --------
    >>> import upglow
    >>> contract = upglow.Contract(space="rec2020", illuminant="D50")
    >>> [round(v, 3) for v in contract.white_xyz.tolist()]
    [0.964, 1.0, 0.825]
    """

    __slots__ = ("_native",)

    def __init__(
        self,
        *,
        space: str | Sequence[float] = "acescg",
        illuminant: Any = "D65",
        adaptation: str = "bradford",
    ) -> None:
        chosen: str | list[float] = space if isinstance(space, str) else [float(v) for v in space]
        if not isinstance(chosen, str) and len(chosen) != 8:
            raise ValueError(f"space has {len(chosen)} numbers, expected a name or eight numbers")
        light = Illuminant(illuminant)
        self._native = _upglow.Contract(chosen, light._native, adaptation)

    @classmethod
    def _of(cls, native: _upglow.Contract) -> Contract:
        contract = cls.__new__(cls)
        contract._native = native
        return contract

    @staticmethod
    def spaces() -> list[str]:
        """The names of the built-in RGB spaces."""
        return _upglow.Contract.spaces()

    @property
    def space(self) -> str:
        """Name of the RGB space; ``custom`` for one of eight numbers."""
        return self._native.space

    @property
    def primaries_xy(self) -> NDArray[np.float64]:
        """CIE 1931 chromaticities, ``[red green blue][x y]``; shape (3, 2)."""
        return self._native.primaries_xy

    @property
    def white_xy(self) -> NDArray[np.float64]:
        """CIE 1931 chromaticity of the space's white; shape (2,)."""
        return self._native.white_xy

    @property
    def illuminant(self) -> Illuminant:
        """The light that materials are seen under."""
        return Illuminant(self._native.illuminant)

    @property
    def observer(self) -> str:
        """Name of the observer."""
        return self._native.observer

    @property
    def adaptation(self) -> str:
        """``bradford`` or ``none``."""
        return self._native.adaptation

    @property
    def white_xyz(self) -> NDArray[np.float64]:
        """XYZ of the perfect diffuser under the light, sums over 5 nm; shape (3,), Y = 1."""
        return self._native.white_xyz

    @property
    def xyz_from_rgb(self) -> NDArray[np.float64]:
        """The matrix that takes RGB to XYZ: ``xyz = rgb @ contract.xyz_from_rgb.T``; (3, 3)."""
        return self._native.xyz_from_rgb

    @property
    def rgb_from_xyz(self) -> NDArray[np.float64]:
        """The matrix that takes XYZ to RGB: ``rgb = xyz @ contract.rgb_from_xyz.T``; (3, 3)."""
        return self._native.rgb_from_xyz

    def __repr__(self) -> str:
        return (
            f"Contract(space={self.space!r}, illuminant={self.illuminant.name!r}, "
            f"adaptation={self.adaptation!r})"
        )
