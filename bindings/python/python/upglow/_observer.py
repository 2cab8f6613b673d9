"""Observers."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from . import _upglow
from ._named_table import NamedTable


class Observer(NamedTable):
    """An observer: color-matching functions from 300 to 830 nm by 1 nm.

    Parameters
    ----------
    source
        A built-in name in any case (``cie-1931-2deg``, ``cie-1964-10deg``, ``cie-2015-2deg``,
        ``cie-2015-10deg``), the path of a CSV file with the header
        ``wavelength_nm,x,y,z``, a pair ``(wavelengths_nm, matching)`` of arrays of shapes (n,) and
        (n, 3), or a ``colour.MultiSpectralDistributions`` of three, such as
        ``colour.MSDS_CMFS["Stockman & Sharpe 2 Degree Cone Fundamentals"]``. Samples cover at least 400 to
        700 nm in steps of at most 5 nm, and are 0 or more; beyond them, and where samples at either
        end are NaN, the functions are 0. Below 360 nm samples must be 0.
    name
        The name that files state; by default that of the source. A file's is its stem, or its whole
        name where the stem is that of a built-in observer with other numbers; an object's gets
        " (samples)" there. A built-in ``name`` with other numbers is refused.

    Raises
    ------
    ValueError
        If the name is unknown or the samples are not a valid observer.
    OSError
        If the file cannot be read.

    Examples
    --------
    >>> import upglow
    >>> upglow.Observer("cie-1931-2deg").matching.shape
    (531, 3)
    """

    __slots__ = ()

    _native: _upglow.Observer
    _kind, _values, _columns = _upglow.Observer, "matching", 3

    @property
    def matching(self) -> NDArray[np.float64]:
        """x, y and z at each wavelength of ``upglow.FINE_NM``; shape (531, 3)."""
        return self._native.matching
