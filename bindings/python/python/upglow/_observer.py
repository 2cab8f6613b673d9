"""Observers."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _upglow
from ._html import curves, table
from ._named_table import NamedTable
from ._spectra import distributions
from ._wavelengths import FINE_NM

if TYPE_CHECKING:
    import colour


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
        If the name is unknown, the samples are not a valid observer, or another ``name`` comes without
        samples.
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

    def to_colour(self) -> colour.MultiSpectralDistributions:
        """The functions from 360 nm on, as spectra of colour-science with the labels of its own.

        ``Observer(observer.to_colour())`` is the observer again. ``ImportError`` without the package
        ``colour-science``.
        """
        return distributions(self.name, *self._given(), ["x_bar", "y_bar", "z_bar"])

    def _given(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The wavelengths at which an observer may see, nm, and the functions there."""
        is_given = FINE_NM >= 360.0
        return FINE_NM[is_given], self.matching[is_given]

    def _repr_html_(self) -> str:
        drawing = curves(FINE_NM, *self.matching.T, colors=("#c33", "#393", "#33c"))
        return table(f"Observer {self.name}", {"functions": "x, y, z from 300 to 830 nm"}, drawing)

    def __reduce__(self) -> tuple[Any, ...]:
        return partial(Observer, name=self.name), (self._given(),)
