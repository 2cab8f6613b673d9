"""Lights."""

from __future__ import annotations

import sys
import warnings
from functools import partial
from typing import TYPE_CHECKING, Any, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from . import _upglow
from ._html import curves, table
from ._kinds import real
from ._named_table import NamedTable
from ._spectra import distribution
from ._wavelengths import FINE_NM

if TYPE_CHECKING:
    import colour


class Illuminant(NamedTable):
    """A light: relative spectral power from 300 to 830 nm by 1 nm.

    Parameters
    ----------
    source
        A built-in name in any case, the path of a CSV file with the header
        ``wavelength_nm,power``, a pair ``(wavelengths_nm, power)`` of arrays of shape (n,), or a
        ``colour.SpectralDistribution``. Built in are ``D50``, ``D55``, ``D60``, ``D65``, ``D75``,
        ``A``, ``E``, the CIE's lamps (``FL1`` to ``FL12``, ``FL3.1`` to ``FL3.15``, ``HP1`` to
        ``HP5``, ``LED-B1`` to ``LED-V2``), daylight behind windows (``ID50``, ``ID65``), the
        measurement conditions ``M0``, ``M1`` and ``M2``, blackbodies such as ``3000K``, and
        daylights such as ``D6200K``. Sampled light covers 300 to 830 nm in steps of at most 10 nm;
        powers are 0 or more. It is linear between samples, so lines need several samples across
        their width, unless samples are means over their steps.
    name
        The name that files state; by default that of the source. A file's is its stem, or its whole
        name where the stem is that of a built-in light with other numbers; an object's gets
        " (samples)" there. A built-in ``name`` with other numbers is refused.
    ends
        The power beyond samples that end at 400 to 700 nm or farther, within 300 to 830 nm:
        ``zero``, or ``hold`` for that of the nearest sample. By default such samples are refused.

    Raises
    ------
    ValueError
        If the name is unknown, the samples are not a valid light, or ``ends`` or another ``name`` comes
        without samples.
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

    def __init__(
        self,
        source: Any,
        *,
        name: str | None = None,
        ends: Literal["zero", "hold"] | None = None,
    ) -> None:
        self._native = self._native_of(source, name, *([] if ends is None else [ends]))

    @classmethod
    def line(cls, peak_nm: float, fwhm_nm: float, *, name: str | None = None) -> Illuminant:
        """A lamp with one Gaussian line, such as an ultraviolet LED.

        ``peak_nm`` is its wavelength and ``fwhm_nm`` its full width at half maximum, 0.001 or more,
        both nm.
        """
        peak, fwhm = real("peak_nm", peak_nm), real("fwhm_nm", fwhm_nm)
        return cls(_upglow.Illuminant.line(name or f"{peak:g} nm line", peak, fwhm))

    @property
    def power(self) -> NDArray[np.float64]:
        """Relative power at each wavelength of ``upglow.FINE_NM``; shape (531,)."""
        return self._native.power

    @property
    def given_nm(self) -> tuple[int, int]:
        """First and last wavelength at which the power is known, nm; it is zero beyond.

        The CIE's lamps are given from 380 to 780 nm.
        """
        first, last = self._native.given_nm
        return first, last

    def to_colour(self) -> colour.SpectralDistribution:
        """The power where it is known, as a spectrum of colour-science.

        ``Illuminant(light.to_colour(), ends="zero")`` is the light again. ``ImportError`` without the
        package ``colour-science``.
        """
        return distribution(self.name, *self._given())

    def _given(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Wavelengths at which the power is known, nm, and the power there."""
        first, last = self.given_nm
        is_given = (first <= FINE_NM) & (last >= FINE_NM)
        return FINE_NM[is_given], self.power[is_given]

    def _repr_html_(self) -> str:
        first, last = self.given_nm
        drawing = curves(FINE_NM, self.power, colors=("currentColor",))
        return table(f"Illuminant {self.name}", {"known": f"{first} to {last} nm"}, drawing)

    def _key(self) -> tuple[Any, ...]:
        return *super()._key(), self.given_nm

    def __reduce__(self) -> tuple[Any, ...]:
        return partial(Illuminant, name=self.name, ends="zero"), (self._given(),)


class _Lit(Protocol):
    """What of the native half is seen under lights."""

    def missing_ultraviolet(self, light: _upglow.Illuminant) -> str | None:
        """What is to say about it under a light."""


def warn_of_ultraviolet(seen: _Lit, light: Illuminant) -> None:
    """Warns where the caller of this package is, if a dye absorbs ultraviolet that the light does not state."""
    if missing := seen.missing_ultraviolet(light._native):
        frame, depth = sys._getframe(1), 2
        while frame.f_back and frame.f_globals.get("__name__", "").split(".")[0] == __package__:
            frame, depth = frame.f_back, depth + 1
        warnings.warn(missing, stacklevel=depth)
