"""Lights."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _upglow
from ._names_and_files import named_or_read
from ._wavelengths import samples


class Illuminant:
    """A light: relative spectral power from 300 to 830 nm by 1 nm.

    Parameters
    ----------
    source
        A built-in name (``D65``, ``D60``, ``D55``, ``D50``, ``A``, ``E``; any case), the path of a
        CSV file with the header ``wavelength_nm,power``, a pair ``(wavelengths_nm, power)`` of
        arrays of shape (n,), or a ``colour.SpectralDistribution``. Sampled light covers 300 to 830
        nm in steps of at most 10 nm; powers are 0 or more.
    name
        The name that files state; by default that of the source.

    Raises
    ------
    ValueError
        If the name is unknown or the samples are no light.
    OSError
        If the file cannot be read.

    Examples
    --------
    >>> import upglow
    >>> upglow.Illuminant("D50").power.shape
    (531,)
    """

    __slots__ = ("_native",)

    def __init__(self, source: Any, *, name: str | None = None) -> None:
        self._native = _native(source, name)

    @classmethod
    def line(cls, peak_nm: float, fwhm_nm: float, *, name: str | None = None) -> Illuminant:
        """A lamp with one Gaussian line, such as an ultraviolet LED.

        ``peak_nm`` is its wavelength and ``fwhm_nm`` its full width at half maximum, both nm.
        """
        return cls(_upglow.Illuminant.line(name or f"{peak_nm:g} nm line", peak_nm, fwhm_nm))

    @staticmethod
    def names() -> list[str]:
        """The names of the built-in lights."""
        return _upglow.Illuminant.names()

    @property
    def name(self) -> str:
        """The name that files state."""
        return self._native.name

    @property
    def power(self) -> NDArray[np.float64]:
        """Relative power at each wavelength of ``upglow.FINE_NM``; shape (531,)."""
        return self._native.power

    def __repr__(self) -> str:
        return f"Illuminant({self.name!r})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Illuminant) and self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())

    def _key(self) -> tuple[str, bytes]:
        return self.name, self.power.tobytes()


def _native(source: Any, name: str | None) -> _upglow.Illuminant:
    if isinstance(source, _upglow.Illuminant):
        return source
    if isinstance(source, Illuminant):
        return source._native
    if isinstance(source, (str, os.PathLike)):
        kind = _upglow.Illuminant
        return named_or_read(os.fspath(source), name, kind.named, kind.from_csv)
    nm, power = samples("illuminant", source)
    label = name or str(getattr(source, "name", "custom"))
    return _upglow.Illuminant.from_samples(label, nm.tolist(), power.tolist())
