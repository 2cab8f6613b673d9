"""A cube for variants that work on one ray at a time: each evaluation is a call of the library."""

from __future__ import annotations

from typing import Any

import numpy as np

from .._cube import Cube
from ._host import spectrum_of
from ._jit_cube import Fluorescence
from ._lamps import Lamps

_BELOW_ONE = 1 - 2.0**-24
"""The greatest single-precision number below 1: the library refuses 1, to which rounding may lead."""

_TINY = 1e-12
"""A lower bound of probabilities, so that nothing is divided by 0."""


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

    def fluorescence(self, lamps: Lamps | None = None) -> Fluorescence:
        """As `JitCube.fluorescence`. Half of the draws follow the lamps, if there are any."""

        return lambda color, out_nm, choice, u, active=True: self._drawn(
            lamps, _rgb(color), np.array(list(out_nm)), choice, u
        )

    def _drawn(self, lamps: Lamps | None, rgb: Any, known: Any, choice: Any, u: Any) -> Any:
        steps = np.arange(len(known)) / len(known)
        pairs = np.stack([(choice + steps) % 1, (u + steps) % 1], axis=-1)
        follows = np.zeros(len(known), dtype=bool)
        lit_nm = known
        if lamps is not None:
            draws = [lamps.draw(*pair) for pair in pairs.tolist()]
            follows, lit_nm, pairs[:, 0] = (np.array(part) for part in zip(*draws, strict=True))
        kept = self._cube.incident_elastic_probability(rgb, known)
        # A choice above the probability of reflection selects fluorescence.
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
