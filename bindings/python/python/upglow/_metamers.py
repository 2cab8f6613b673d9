"""The materials that may have a color, known under one light or more."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _upglow
from ._arrays import Threads, numbers, refuse_outside, rgb_array
from ._contract import Contract
from ._cube import Cube, Relit
from ._html import table
from ._illuminant import Illuminant, warn_of_ultraviolet
from ._kinds import instance, real, wrong
from ._materials import Materials
from ._matrix import DonaldsonMatrix, MatrixDifference
from ._models import Dye, _native_set

Rgb = tuple[float, float, float]


class MetamerColors(NamedTuple):
    """How n materials look under one light."""

    probability: NDArray[np.float64]
    """Of each material, adding up to 1, the greatest first; shape (n,)."""
    xyz: NDArray[np.float64]
    """X, Y, Z of each, relative to white as in `Relit`; shape (n, 3)."""


class OwnMaterial:
    """A material, or a blend of up to four, with a model of its own: films of dyes whose yields are fitted.

    An answer of `Metamers`. Its methods are those of a `Cube`, without the color.
    """

    def __init__(self) -> None:
        raise TypeError("such a material comes from upglow.metamers")

    _cube: Cube
    _blending: Cube
    _rgb: Rgb

    @classmethod
    def _of(cls, answer: tuple[_upglow.Cube, _upglow.Cube, list[float]]) -> OwnMaterial:
        material = cls.__new__(cls)
        cube, blending, (red, green, blue) = answer
        material._cube, material._blending = Cube._of(cube), Cube._of(blending)
        material._rgb = red, green, blue
        return material

    @property
    def _parts(self) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
        """Nodes of the blending cube, (parts, 3), and their weights."""
        nodes, weights = self._blending.corners(self._rgb)
        return nodes[weights > 0.0], weights[weights > 0.0]

    @property
    def materials(self) -> Materials:
        """The materials that are blended; shape (parts,). Their dyes are numbers of `dye_names`."""
        nodes, _ = self._parts
        return self._blending.nodes[tuple(nodes.T)]

    @property
    def weights(self) -> NDArray[np.float64]:
        """The weight of each, adding up to 1; shape (parts,)."""
        return self._parts[1]

    @property
    def dye_names(self) -> list[str]:
        """The dyes, with the yields that were fitted."""
        return self._blending.dye_names

    def cube(self) -> Cube:
        """A cube of 2³ nodes that are all this material: any RGB looks it up.

        Of a blend, it is the material of the greatest weight.
        """
        return self._cube

    def reflectance(self, wavelengths_nm: ArrayLike) -> NDArray[np.float64]:
        """As `Cube.reflectance`; shape (n,)."""
        return self._blending.reflectance(self._rgb, wavelengths_nm)

    def reradiation_matrix(self, wavelengths_nm: ArrayLike | None = None) -> NDArray[np.float64]:
        """As `Cube.reradiation_matrix`; shape (n, n)."""
        return self._blending.reradiation_matrix(self._rgb, wavelengths_nm)

    def radiance_factor(
        self, wavelengths_nm: ArrayLike | None = None, *, light: Any = None
    ) -> NDArray[np.float64]:
        """As `Cube.radiance_factor`; shape (n,)."""
        return self._blending.radiance_factor(self._rgb, wavelengths_nm, light=light)

    def relight(self, lights: Sequence[Any], *, observer: Any = None) -> Relit:
        """As `Cube.relight`; shapes (n,) and (n, 3) for n lights."""
        return self._blending.relight(self._rgb, lights, observer=observer)

    def difference(self, measured: DonaldsonMatrix, light: Any = "D65") -> MatrixDifference:
        """How the material looks beside a measured matrix under a light."""
        instance("measured", measured, DonaldsonMatrix)
        fitted = _upglow.matrix_like(self._blending._native, self._rgb, measured._native)
        return measured._difference(fitted, light)

    def __repr__(self) -> str:
        return f"OwnMaterial(parts: {self.weights.size}, dyes: {len(self.dye_names)})"


class Metamers:
    """The materials that may have a color, with their probabilities; made by `upglow.metamers`."""

    _native: _upglow.Metamers
    _kind: str
    _known: dict[str, str]

    def __init__(self) -> None:
        raise TypeError("metamers come from upglow.metamers")

    @cached_property
    def fluorescent_probability(self) -> float:
        """The probability that a paint of these colors fluoresces, where of twenty paints one does.

        It does not depend on ``kind``; if that was given, another search takes half a second.
        """
        return self._native.fluorescent_probability

    @cached_property
    def single(self) -> OwnMaterial:
        """The material with the least expected error: the best answer if it may be one material only."""
        return OwnMaterial._of(self._native.single())

    @cached_property
    def mixture(self) -> OwnMaterial:
        """The blend of up to four materials that comes nearest to the mean colors of all."""
        return OwnMaterial._of(self._native.mixture())

    def colors(self, light: Any) -> MetamerColors:
        """How all materials look under a light, an `Illuminant` or what one is made from."""
        return MetamerColors(*self._native.colors(self._lit(light)))

    def mean(self, light: Any) -> NDArray[np.float64]:
        """The mean of `colors`, X, Y, Z; shape (3,)."""
        return np.array(self._native.mean(self._lit(light)))

    def band(
        self,
        light: Any,
        answer: ArrayLike | Literal["mean", "single", "mixture"] = "mean",
        *,
        share: float = 0.9,
    ) -> float:
        """How far an answer may be off: the CIEDE2000 from it within which a share of the materials is.

        ``answer`` is X, Y, Z under the light, or that of the `mean`, of `single` or of `mixture`. ``share`` is 0 to
        1, by probability. What the model itself may be off is part of the band.
        """
        lit = Illuminant(light)
        center: Any
        if not isinstance(answer, str):
            center = numbers("answer", answer)
        elif answer == "mean":
            center = self.mean(lit)
        elif answer in ("single", "mixture"):
            material = self.single if answer == "single" else self.mixture
            (center,) = material.relight([lit]).xyz
        else:
            raise ValueError(f"answer is {answer!r}, expected mean, single, mixture or X, Y, Z")
        xyz = _triple("answer", center)
        if not np.isfinite(xyz).all():
            raise ValueError(f"answer is {xyz.tolist()}, expected finite X, Y, Z")
        return self._native.band(self._lit(lit), xyz.tolist(), real("share", share))

    def _lit(self, light: Any) -> _upglow.Illuminant:
        illuminant = Illuminant(light)
        warn_of_ultraviolet(self._native, illuminant)
        return illuminant._native

    def __repr__(self) -> str:
        return f"Metamers({self._kind}, known under {', '.join(self._known)})"

    def _repr_html_(self) -> str:
        rows = {"kind": self._kind} | {f"RGB under {name}": rgb for name, rgb in self._known.items()}
        rows["fluoresces"] = f"with a probability of {100 * self.fluorescent_probability:.0f} %"
        return table("Materials that may have a color", rows)


def metamers(
    rgb: ArrayLike,
    contract: Contract | None = None,
    *,
    known: Mapping[Any, ArrayLike] | Sequence[tuple[Any, ArrayLike]] = (),
    kind: Literal["any", "ordinary", "fluorescent"] = "any",
    dyes: str | os.PathLike[str] | Sequence[Dye] = "all",
    threads: Threads = None,
) -> Metamers:
    """All materials that may have a color: what it may look like under other lights, and how sure that is.

    Each is a film of two dyes over a smooth reflectance. How probable it is follows from how well it has the
    known colors, and from what is usual for paint. A search takes half a second.

    Parameters
    ----------
    rgb
        Linear RGB of one color under the light of the contract, shape (3,), 0 to 10.
    contract
        What RGB means; ACEScg under D65 by default. For measured X, Y, Z, where white has Y = 1:
        ``Contract(space="xyz", adaptation="none")``.
    known
        The color under one or two more lights, ``{light: rgb}`` or ``[(light, rgb), …]``: linear RGB as
        `Cube.relight` returns it, relative to white under each light. A light is an `Illuminant`, or what one is
        made from; ``D65-cut400`` is D65 behind a filter that takes out ultraviolet.
    kind
        What is known of the paint: that it is ``ordinary``, that it is ``fluorescent``, or nothing. A paint that
        does not fluoresce is shown worse if it is taken to: with a mean error of 5.8 in place of 1.7
        CIEDE2000 under other lights.
    dyes
        ``all`` that are built in; or a set, a folder or a list of `Dye` as in `Film`.

    Raises
    ------
    ValueError
        If there are more than three colors, or one is no color of a material.

    Examples
    --------
    >>> import upglow
    >>> orange = upglow.metamers([0.9, 0.3, 0.02], known={"D65-cut400": [0.6, 0.2, 0.02]})
    >>> orange.fluorescent_probability > 0.9
    True
    >>> orange.mixture.reflectance([450.0, 550.0, 650.0]).shape
    (3,)
    """
    agreed = Contract._or_default(contract)
    own = rgb_array(rgb).astype(np.float64, copy=False)
    if own.shape != (3,):
        raise ValueError(f"rgb has shape {own.shape}, expected one color, (3,)")
    refuse_outside(own, to_fit=True)
    pairs = list(known.items()) if isinstance(known, Mapping) else known
    if not isinstance(pairs, (list, tuple)):
        raise wrong("known", known, "{light: rgb} or a list of pairs (light, rgb)")
    lights, colors = [agreed.illuminant], [own]
    for i, pair in enumerate(pairs):
        if not isinstance(pair, (list, tuple)) or len(pair) != 2:
            raise wrong(f"known[{i}]", pair, "a pair (light, rgb)")
        light = Illuminant(pair[0])
        lights.append(light)
        what = f"the color under {light.name}"
        colors.append(_triple(what, numbers(what, pair[1])))
    chosen = None if isinstance(dyes, str) and dyes == "all" else _native_set(dyes, False)
    others = [light._native for light in lights[1:]]
    native = _upglow.metamers(agreed._native, others, np.stack(colors), kind, chosen, threads)
    for light in lights:
        warn_of_ultraviolet(native, light)
    found = Metamers.__new__(Metamers)
    found._native, found._kind = native, kind
    names = [light.name for light in lights]
    found._known = {name: str(tuple(c.tolist())) for name, c in zip(names, colors, strict=True)}
    return found


def _triple(what: str, numbers_of_color: NDArray[np.float64]) -> NDArray[np.float64]:
    if numbers_of_color.shape != (3,):
        raise ValueError(f"{what} has shape {numbers_of_color.shape}, expected (3,)")
    return numbers_of_color
