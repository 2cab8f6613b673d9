"""Models: what fluoresces in a material, and by what rules."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from . import _upglow
from ._kinds import instance, real, wrong
from ._named_table import is_path
from ._spectra import samples


@dataclass(frozen=True, kw_only=True)
class Dye:
    """A measured dye. Curves are pairs ``(wavelengths_nm, values)`` or colour-science's spectra.

    Parameters
    ----------
    name
        The dye's name.
    absorption
        Share of incident light that is absorbed, 0 to 1; 1 is black at that wavelength.
    emission
        Emission, relative, 0 or more, at the same wavelengths.
    quantum_yield
        Photons emitted per photon absorbed, 0 to 1; ``None`` if it was not measured.

    A built-in name with other numbers is refused, and so is a dye whose mean emission is at a shorter
    wavelength than its mean absorption.

    Wavelengths ascend from 300 to 830 nm in steps of at most 5 nm. NaN at either end of a curve
    means that it was not measured there, and counts as zero.
    """

    name: str
    absorption: Any = field(repr=False)
    emission: Any = field(repr=False)
    quantum_yield: float | None = None

    def _samples(self) -> tuple[str, list[float], list[float], list[float], float | None]:
        nm, absorption = samples(f"absorption of {self.name}", self.absorption)
        emission_nm, emission = samples(f"emission of {self.name}", self.emission)
        if nm.tolist() != emission_nm.tolist():
            raise ValueError(f"dye {self.name}: emission at other wavelengths, expected the same")
        yields = None if self.quantum_yield is None else real("quantum_yield", self.quantum_yield)
        return instance("name of a dye", self.name, str, "a text"), nm.tolist(), absorption.tolist(), emission.tolist(), yields


@dataclass(frozen=True, kw_only=True)
class Dyes:
    """Fluorescence by two neighbors of a ring of measured dyes.

    Parameters
    ----------
    set
        A built-in set (``wide8``, ``konig8``, ``open8``,
            ``wide14``), a folder of CSV files with the header
        ``wavelength_nm,absorption,emission``, or a list of `Dye` in ring order.
    accounting
        What re-radiation conserves at a quantum yield of 1: ``energy`` or ``photon``.
    mixing
        ``pooled``: light absorbed by either dye is re-emitted with the mixed emission spectrum.
        ``separate``: each dye re-emits what it absorbed itself.
    quantum_yield
        Share of the absorbed light that is re-emitted, 0 to 1, or ``"measured"``.
    optical_density
        Peak optical density A > 0 of the dyes at full concentration: the absorptance is then
        1 - 10^(-A·a), a being the measured curve. ``None``: a thin solution, of absorptance a.
    normalize
        Divide the absorption and the emission of each dye by their peaks, for curves in other units
        than fractions. Only for a folder or a list.
    """

    set: str | os.PathLike[str] | Sequence[Dye] = "konig8"
    accounting: str = "energy"
    mixing: str = "pooled"
    quantum_yield: float | str = 1.0
    optical_density: float | None = None
    normalize: bool = False

    @staticmethod
    def sets() -> list[str]:
        """The names of the built-in sets."""
        return _upglow.DyeSet.names()

    def names(self) -> list[str]:
        """The dyes' names in ring order."""
        return self._native_set().dyes

    def _native_set(self) -> _upglow.DyeSet:
        return _native_set(self.set, self.normalize)

    def _native(self) -> _upglow.Model:
        density = self.optical_density
        if density is not None:
            density = real("optical_density", density, "a number or None")
        rules = self.accounting, self.mixing, _yield(self.quantum_yield), density
        return _upglow.Model.dyes(self._native_set(), *rules)


@dataclass(frozen=True, kw_only=True)
class Film:
    """Fluorescence by any two dyes of a set in a film, each at an optical density of its own, 0 to 6.

    Parameters
    ----------
    set, normalize
        As in `Dyes`, in any order; the default is the set of the preset ``natural``.
    accounting
        What re-radiation conserves at a quantum yield of 1: ``energy`` or ``photon``.
    quantum_yield
        Share of the absorbed light that is re-emitted, 0 to 1, or ``"measured"``.
    """

    set: str | os.PathLike[str] | Sequence[Dye] = "wide8"
    accounting: str = "photon"
    quantum_yield: float | str = 1.0
    normalize: bool = False

    def names(self) -> list[str]:
        """The dyes' names in the order of the set."""
        return self._native_set().dyes

    def _native_set(self) -> _upglow.DyeSet:
        return _native_set(self.set, self.normalize)

    def _native(self) -> _upglow.Model:
        return _upglow.Model.film(self._native_set(), self.accounting, _yield(self.quantum_yield))


def _native_set(
    dyes: str | os.PathLike[str] | Sequence[Dye], normalize: bool
) -> _upglow.DyeSet:
    if not isinstance(dyes, (str, os.PathLike)):
        if not isinstance(dyes, (list, tuple)):
            raise wrong("the set of dyes", dyes, "a name, a folder or a list of Dye")
        sampled = [instance(f"dye {i}", dye, Dye)._samples() for i, dye in enumerate(dyes)]
        return _upglow.DyeSet.from_samples("custom", sampled, normalize)
    word = os.fspath(dyes)
    if word in _upglow.DyeSet.names() or not is_path(word):
        if normalize:
            raise ValueError(f"normalize with the set {word!r}, expected a folder or a list")
        return _upglow.DyeSet.named(word)
    return _upglow.DyeSet.from_folder(word, normalize)


def _yield(given: float | str) -> float | str:
    if isinstance(given, str):
        return given
    return real("quantum_yield", given, "a number or 'measured'")


@dataclass(frozen=True, kw_only=True)
class Analytic:
    """Fluorescence by formula: absorption and emission are cubic B-splines.

    Parameters
    ----------
    absorption_fwhm_nm, emission_fwhm_nm
        Full widths at half maximum, 15 to 80 nm.
    accounting
        What re-radiation conserves at a quantum yield of 1: ``energy`` or ``photon``.
    quantum_yield
        Share of the absorbed light that is re-emitted, 0 to 1.
    """

    absorption_fwhm_nm: float = 50.0
    emission_fwhm_nm: float = 45.0
    accounting: str = "energy"
    quantum_yield: float = 1.0

    def _native(self) -> _upglow.Model:
        return _upglow.Model.analytic(
            real("absorption_fwhm_nm", self.absorption_fwhm_nm),
            real("emission_fwhm_nm", self.emission_fwhm_nm),
            self.accounting,
            real("quantum_yield", self.quantum_yield),
        )


@dataclass(frozen=True, kw_only=True)
class Reflectance:
    """No fluorescence."""

    def _native(self) -> _upglow.Model:
        return _upglow.Model.reflectance()


Model = Dyes | Film | Analytic | Reflectance
