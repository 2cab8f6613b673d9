"""Lights."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from . import _upglow
from ._named_table import NamedTable


class Illuminant(NamedTable):
    """A light: relative spectral power from 300 to 830 nm by 1 nm.

    Parameters
    ----------
    source
        A built-in name (``D65``, ``D60``, ``D55``, ``D50``, ``A``, ``E``, ``FL2``, ``FL11``,
        ``HP1``, ``LED-B3``; any case), the path of a
        CSV file with the header ``wavelength_nm,power``, a pair ``(wavelengths_nm, power)`` of
        arrays of shape (n,), or a ``colour.SpectralDistribution``. Sampled light covers 300 to 830
        nm in steps of at most 10 nm; powers are 0 or more. It is linear between samples, so lines need
        several samples across their width, unless samples are means over their steps.
    name
        The name that files state; by default that of the source. A file's is its stem, or its whole
        name where the stem is that of a built-in light with other numbers; an object's gets
        " (samples)" there. A built-in ``name`` with other numbers is refused.

    Raises
    ------
    ValueError
        If the name is unknown or the samples are not a valid light.
    OSError
        If the file cannot be read.

    Examples
    --------
    >>> import upglow
    >>> upglow.Illuminant("D50").power.shape
    (531,)
    """

    __slots__ = ()

    _native: _upglow.Illuminant
    _kind, _values = _upglow.Illuminant, "power"

    @classmethod
    def line(cls, peak_nm: float, fwhm_nm: float, *, name: str | None = None) -> Illuminant:
        """A lamp with one Gaussian line, such as an ultraviolet LED.

        ``peak_nm`` is its wavelength and ``fwhm_nm`` its full width at half maximum, 0.001 or more,
        both nm.
        """
        return cls(_upglow.Illuminant.line(name or f"{peak_nm:g} nm line", peak_nm, fwhm_nm))

    @property
    def power(self) -> NDArray[np.float64]:
        """Relative power at each wavelength of ``upglow.FINE_NM``; shape (531,)."""
        return self._native.power
