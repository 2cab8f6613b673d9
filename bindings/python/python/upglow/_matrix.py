"""Measured re-radiation matrices, and the materials of them."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _upglow
from ._arrays import numbers
from ._cube import Cube
from ._illuminant import Illuminant, warn_of_ultraviolet
from ._kinds import instance, whole
from ._models import Dye, _native_set
from ._observer import Observer
from ._spectra import samples


class DonaldsonMatrix:
    """A measured re-radiation matrix: which share of the power that arrives in one band leaves in another.

    Parameters
    ----------
    incident_nm, outgoing_nm
        Where light arrives and where it leaves, ascending, nm; the outgoing ones cover 400 to 700 nm.
    values
        Shares, shape (outgoing, incident). On the diagonal they hold reflected and re-emitted light
        together. What is below it is noise: it is kept.
    unit
        ``per band``, or ``per nm`` of the outgoing wavelength.
    reflectance
        Where light that is reflected was measured apart: a pair ``(wavelengths_nm, reflectance)`` of
        arrays of shape (n,), or a ``colour.SpectralDistribution``, at wavelengths of both axes. It
        replaces the diagonal.

    Raises
    ------
    ValueError
        If the numbers are no matrix.

    Examples
    --------
    >>> import numpy as np, upglow
    >>> nm = np.arange(380.0, 781.0, 10.0)
    >>> gray = upglow.DonaldsonMatrix(nm, nm, 0.5 * np.eye(41), unit="per band")
    >>> gray.color("A").round(3).tolist()
    [0.549, 0.5, 0.178]
    """

    __slots__ = ("_native",)

    _native: _upglow.DonaldsonMatrix

    def __init__(
        self,
        incident_nm: ArrayLike,
        outgoing_nm: ArrayLike,
        values: ArrayLike,
        *,
        unit: Literal["per band", "per nm"],
        reflectance: Any = None,
    ) -> None:
        incident = _doubles("incident_nm", incident_nm, 1)
        outgoing = _doubles("outgoing_nm", outgoing_nm, 1)
        shares = _doubles("values", values, 2)
        apart = None
        if reflectance is not None:
            nm, reflected = samples("reflectance", reflectance)
            apart = list(zip(nm.tolist(), reflected.tolist(), strict=True))
        self._native = _upglow.DonaldsonMatrix.from_samples(
            incident, outgoing, shares, unit, apart
        )

    @classmethod
    def _of(cls, native: _upglow.DonaldsonMatrix) -> DonaldsonMatrix:
        matrix = cls.__new__(cls)
        matrix._native = native
        return matrix

    @classmethod
    def from_bfc(cls, path: str | os.PathLike[str]) -> DonaldsonMatrix:
        """The matrix in a file of the BFC-450 spectrofluorimeter."""
        return cls._of(_read(path, _upglow.DonaldsonMatrix.from_bfc))

    @classmethod
    def from_csv(cls, path: str | os.PathLike[str]) -> DonaldsonMatrix:
        r"""The matrix in a CSV file whose first cell is ``outgoing_nm\incident_nm per_band``.

        Or ``incident_nm\outgoing_nm``, or ``per_nm``: lines are the axis named first.
        """
        return cls._of(_read(path, _upglow.DonaldsonMatrix.from_csv))

    def __repr__(self) -> str:
        outgoing, incident = self.per_band.shape
        return f"DonaldsonMatrix({outgoing} outgoing x {incident} incident bands, {self.diagonal})"

    @property
    def incident_nm(self) -> NDArray[np.float64]:
        """Where light arrives, nm; shape (incident,)."""
        return self._native.incident_nm

    @property
    def outgoing_nm(self) -> NDArray[np.float64]:
        """Where light leaves, nm; shape (outgoing,)."""
        return self._native.outgoing_nm

    @property
    def per_band(self) -> NDArray[np.float64]:
        """The share that leaves within each outgoing band; shape (outgoing, incident)."""
        return self._native.per_band

    @property
    def diagonal(self) -> str:
        """``together``: reflected and re-emitted light; ``reflected``: reflected light alone."""
        return self._native.diagonal

    @property
    def noise(self) -> tuple[float, float] | None:
        """Root mean square and greatest size below the diagonal, per band; None if nothing is there."""
        found = self._native.noise
        return None if found is None else (found[0], found[1])

    def color(self, light: Any = "D65", observer: Any = "cie-1931-2deg") -> NDArray[np.float64]:
        """X, Y, Z under a light by the sums of ASTM E2152; the perfect diffuser has Y = 1.

        ``light`` and ``observer`` are an `Illuminant` and an `Observer`, or what these are made from.
        """
        illuminant, seer = Illuminant(light), Observer(observer)
        warn_of_ultraviolet(self._native, illuminant)
        return np.array(self._native.color(illuminant._native, seer._native))

    def _difference(self, fitted: _upglow.DonaldsonMatrix, light: Any) -> MatrixDifference:
        """How a material looks beside this matrix, on the axes of which it is."""
        illuminant = Illuminant(light)
        warn_of_ultraviolet(self._native, illuminant)
        found = self._native.difference(fitted, illuminant._native)
        own, other, de2000, noise, is_adapted = found
        return MatrixDifference(np.array(own), np.array(other), de2000, noise, is_adapted)


class MatrixDifference(NamedTuple):
    """How a fitted material looks beside the measured matrix under one light."""

    measured: NDArray[np.float64]
    """X, Y, Z of the matrix."""
    fitted: NDArray[np.float64]
    """X, Y, Z of the material."""
    de2000: float
    """CIEDE2000 between the two."""
    noise_de2000: float
    """CIEDE2000 that leaving out all below the diagonal of the measured matrix would make."""
    is_adapted: bool
    """Whether the observer is adapted to the light; if not, it is as strong as D65, and he to that."""


class MatrixFit:
    """A material fitted to a measured matrix, made by `upglow.fit_matrix`."""

    __slots__ = ("_measured", "_native")

    _native: _upglow.MatrixFit
    _measured: DonaldsonMatrix

    @classmethod
    def _of(cls, native: _upglow.MatrixFit, measured: DonaldsonMatrix) -> MatrixFit:
        fit = cls.__new__(cls)
        fit._native, fit._measured = native, measured
        return fit

    def __repr__(self) -> str:
        return f"MatrixFit({self._measured!r})"

    @property
    def matrix(self) -> DonaldsonMatrix:
        """The material as a matrix on the axes of the measured one."""
        return DonaldsonMatrix._of(self._native.matrix)

    def cube(self) -> Cube:
        """A cube of 2³ nodes that are all this material: any RGB looks it up."""
        return Cube._of(self._native.cube())

    def difference(self, light: Any = "D65") -> MatrixDifference:
        """How the material looks beside the measured matrix under a light."""
        return self._measured._difference(self._native.matrix, light)


def fit_matrix(
    measured: DonaldsonMatrix,
    *,
    dyes: str | os.PathLike[str] | Sequence[Dye] = "measured",
    count: int | None = None,
    reflectance: Literal["measured", "sigmoid"] | None = None,
) -> MatrixFit:
    """The material of the model ``film`` that comes nearest to a measured matrix.

    Parameters
    ----------
    measured
        The matrix.
    dyes
        ``measured``: dyes with the absorption and the emission of the matrix. ``all``: the built-in ones.
        Or a set, a folder or a list of `Dye` as in `Film`. Quantum yields are fitted.
    count
        How many dyes emit, 1 or 2; by default one of the matrix, or those of others that come nearest.
    reflectance
        ``measured``, as a dye without emission over white, beside one emitting dye of the matrix; or
        the nearest ``sigmoid``. By default what comes nearer.

    Raises
    ------
    ValueError
        If options do not go together.
    """
    instance("measured", measured, DonaldsonMatrix)
    word = dyes if isinstance(dyes, str) else ""
    chosen = None if word in ("measured", "all") else _native_set(dyes, False)
    dyes_that_emit = None if count is None else whole("count", count)
    native = _upglow.fit_matrix(
        measured._native, chosen, word == "all", dyes_that_emit, reflectance
    )
    return MatrixFit._of(native, measured)


def _doubles(what: str, values: ArrayLike, dimensions: int) -> NDArray[np.float64]:
    array = numbers(what, values)
    if array.ndim != dimensions:
        raise ValueError(f"{what} has {array.ndim} dimensions, expected {dimensions}")
    return np.ascontiguousarray(array)


def _read(path: str | os.PathLike[str], parse: Any) -> _upglow.DonaldsonMatrix:
    text = Path(path).read_text(encoding="utf-8")
    try:
        native: _upglow.DonaldsonMatrix = parse(text)
    except ValueError as error:
        raise ValueError(f"{os.fspath(path)}: {error}") from None
    return native
