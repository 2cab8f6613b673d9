"""Sampled spectra: what callers give, and what goes to colour-science.

Its spectra are known by their `wavelengths` and `values`, so that it need not be installed, and spectra
of other packages that have both are taken as well.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._arrays import numbers
from ._kinds import wrong
from ._wavelengths import nanometers

if TYPE_CHECKING:
    import colour


def samples(
    what: str, curve: Any, *, columns: int | None = None, otherwise: str = ""
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Wavelengths (nm) and values from a pair of arrays or one of colour-science's distributions.

    Values have shape (n,), or (n, columns). ``otherwise`` is what the caller takes too, for the error.
    """
    kind = "SpectralDistribution" if columns is None else "MultiSpectralDistributions"
    expected = f"{otherwise}a pair (wavelengths_nm, values) or a colour.{kind}"
    is_distribution = hasattr(curve, "wavelengths") and hasattr(curve, "values")
    is_list = isinstance(curve, (tuple, list)) or (isinstance(curve, np.ndarray) and curve.ndim > 0)
    if is_distribution:
        wavelengths_nm, values = curve.wavelengths, curve.values
    elif is_list and len(curve) == 2:
        wavelengths_nm, values = curve
    else:
        if is_list:
            raise TypeError(f"{what} has {len(curve)} items, expected {expected}")
        raise wrong(what, curve, expected)
    nm = numbers(f"{what}: wavelengths_nm", wavelengths_nm)
    value = numbers(f"{what}: values", values)
    per_wavelength = () if columns is None else (columns,)
    if nm.ndim != 1 or value.shape != (*nm.shape, *per_wavelength):
        if is_distribution and value.ndim != 1 + len(per_wavelength):
            raise wrong(what, curve, f"a colour.{kind}")
        shapes = "both (n,)" if columns is None else f"(n,) and (n, {columns})"
        raise ValueError(
            f"{what}: wavelengths of shape {nm.shape} and values of shape {value.shape}, "
            f"expected {shapes}"
        )
    return nanometers(f"{what}: wavelengths_nm", nm), value


def distribution(
    name: str, nm: NDArray[np.float64], values: NDArray[Any]
) -> colour.SpectralDistribution:
    """A spectrum of colour-science; values have shape (n,)."""
    made: colour.SpectralDistribution = _package().SpectralDistribution(values, nm, name=name)
    return made


def distributions(
    name: str, nm: NDArray[np.float64], values: NDArray[Any], labels: list[str]
) -> colour.MultiSpectralDistributions:
    """Spectra of colour-science, one for each label; values have shape (n, labels)."""
    make = _package().MultiSpectralDistributions
    made: colour.MultiSpectralDistributions = make(values, nm, labels=labels, name=name)
    return made


def _package() -> Any:
    try:
        return import_module("colour")
    except ImportError as error:
        raise ImportError("this needs colour-science: pip install colour-science") from error
