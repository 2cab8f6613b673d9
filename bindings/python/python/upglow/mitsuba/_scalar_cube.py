"""A cube where the variant works on one ray at a time: each question is one call of the library."""

from __future__ import annotations

from typing import Any

import numpy as np

from .._cube import Cube
from ._host import spectrum_of
from ._jit_cube import Fluorescence
from ._lamps import Lamps


_BELOW_ONE = 1 - 2.0**-24
"""Rounding may lift a choice to 1, which the library refuses; single precision keeps this below 1."""


_TINY = 1e-12
"""A share of fluorescence below which there is none to divide by."""


class ScalarCube:
    """As `JitCube`, for numbers and small vectors."""

    def __init__(self, cube: Cube) -> None:
        self._cube = cube

    @property
    def is_fluorescent(self) -> bool:
        """Whether any material may fluoresce."""
        return self._cube.model != "reflectance"

    def reflectance(self, color: Any, nm: Any, active: Any = True) -> Any:
        """Share of the light at nm that is reflected at the same wavelength, 0 to 1."""
        return spectrum_of(self._cube.reflectance(_rgb(color), list(nm)))

    def albedo(self, color: Any, nm: Any, active: Any = True) -> Any:
        """Share of the light at nm that comes out at any wavelength, 0 to 1."""
        return spectrum_of(self._cube.albedo(_rgb(color), list(nm)))

    def reradiation(self, color: Any, in_nm: Any, out_nm: Any, active: Any = True) -> Any:
        """Energy that leaves per nm at out_nm by fluorescence, per unit that came at in_nm; 1/nm."""
        return spectrum_of(self._cube.reradiation(_rgb(color), list(in_nm), list(out_nm)))

    def fluorescence(self, lamps: Lamps | None = None) -> Fluorescence:
        """Draws of the wavelength of light that comes in, as `JitCube.fluorescence`.

        Half of them follow the lamps, if there are any.
        """

        def drawn(color: Any, out_nm: Any, choice: Any, u: Any, active: Any = True) -> Any:
            return self._drawn(lamps, _rgb(color), np.array(list(out_nm)), choice, u)

        return drawn

    def _drawn(self, lamps: Lamps | None, rgb: Any, known: Any, choice: Any, u: Any) -> Any:
        steps = np.arange(len(known)) / len(known)
        pairs = np.stack([(choice + steps) % 1, (u + steps) % 1], axis=-1)
        follows = np.zeros(len(known), dtype=bool)
        lit_nm = known
        if lamps is not None:
            told = [lamps.draw(*pair) for pair in pairs.tolist()]
            follows, lit_nm, pairs[:, 0] = (np.array(part) for part in zip(*told, strict=True))
        kept = self._cube.incident_elastic_probability(rgb, known)
        # Choices above the probability of reflection fall on fluorescence.
        pairs[:, 0] = kept + (1 - kept) * pairs[:, 0]
        found = self._cube.sample_incident(rgb, known, np.minimum(pairs, _BELOW_ONE))
        is_drawn = ~found.is_elastic & np.isfinite(found.nm)
        nm = np.where(is_drawn, np.where(follows, lit_nm, found.nm), known)
        pdf = self._cube.incident_pdf_per_nm(rgb, nm, known) / np.maximum(1 - kept, _TINY)
        if lamps is not None:
            pdf = np.array(
                [lamps.pdf(*each) for each in zip(nm.tolist(), pdf.tolist(), strict=True)]
            )
        moved = self._cube.reradiation(rgb, nm, known)
        is_drawn &= pdf > 0
        throughput = np.divide(moved, pdf, out=np.zeros(len(known)), where=is_drawn)
        return spectrum_of(throughput), spectrum_of(np.where(is_drawn, nm, known))


def _rgb(color: Any) -> np.ndarray[Any, np.dtype[np.float32]]:
    return np.clip(np.array(list(color), dtype=np.float32), 0, 1)
