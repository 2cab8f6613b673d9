"""Contracts: what RGB means."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _upglow
from ._arrays import numbers
from ._html import table
from ._illuminant import Illuminant
from ._kinds import instance, wrong
from ._observer import Observer


class Contract:
    """The definition of RGB: its space, light, observer and chromatic adaptation.

    Parameters
    ----------
    space
        ``acescg``, ``aces2065-1``, ``rec2020``, ``p3-d65``, ``srgb``, ``prophoto``, ``adobe-rgb``,
        ``xyz``, or eight numbers: CIE 1931 chromaticities x, y of red, green, blue and white.
    illuminant
        The light that materials are seen under: an `Illuminant`, or what one is made from.
    observer
        An `Observer`, or what one is made from. XYZ, whites and color differences are computed for
        it. RGB spaces are standardized for CIE 1931 2° only. For another observer their
        chromaticities are used unchanged, and with ``bradford`` RGB (1, 1, 1) is still the perfect
        diffuser.
    adaptation
        ``bradford``: RGB (1, 1, 1) is the perfect diffuser under the light. ``none``: the space's
        own matrix; R = G = B is then not a neutral gray unless the whites agree.

    Raises
    ------
    ValueError
        If a name is unknown, the numbers do not define a space, or the light has no luminance for
        the observer.

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
        observer: Any = "cie-1931-2deg",
        adaptation: str = "bradford",
    ) -> None:
        if not isinstance(space, str):
            if not isinstance(space, (list, tuple, np.ndarray)):
                raise wrong("space", space, "a name or eight numbers")
            space = numbers("space", space).ravel().tolist()
            if len(space) != 8:
                raise ValueError(f"space has {len(space)} numbers, expected a name or eight numbers")
        light, seen_by = Illuminant(illuminant)._native, Observer(observer)._native
        self._native = _upglow.Contract(space, light, seen_by, adaptation)

    @classmethod
    def _or_default(cls, contract: Contract | None) -> Contract:
        """The contract of a caller, or the default one."""
        return cls() if contract is None else instance("contract", contract, Contract)

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
        """Name of the RGB space; ``custom`` for one given by eight numbers."""
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
    def observer(self) -> Observer:
        """The observer that sees materials."""
        return Observer(self._native.observer)

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

    def _key(self) -> tuple[Any, ...]:
        chromaticities = (*self.primaries_xy.ravel().tolist(), *self.white_xy.tolist())
        return self.space, chromaticities, self.illuminant, self.observer, self.adaptation

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Contract) and self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())

    def __reduce__(self) -> tuple[Any, ...]:
        name, chromaticities, illuminant, observer, adaptation = self._key()
        space = name if name in Contract.spaces() else chromaticities
        same = partial(
            Contract, space=space, illuminant=illuminant, observer=observer, adaptation=adaptation
        )
        return same, ()

    def _names(self) -> dict[str, str]:
        return {
            "space": self.space,
            "illuminant": self.illuminant.name,
            "observer": self.observer.name,
            "adaptation": self.adaptation,
        }

    def __repr__(self) -> str:
        return f"Contract({', '.join(f'{k}={v!r}' for k, v in self._names().items())})"

    def _repr_html_(self) -> str:
        return table("Contract", self._names())
