"""Reads cubes and evaluates materials by the text of docs/cube-format.md alone.

Nothing of the package is used here: this is what the package is compared with.
"""

from __future__ import annotations

import hashlib
import json
import struct
from dataclasses import dataclass
from typing import Any

import numpy as np

NM = np.arange(300.0, 831.0)
KNOT_STEP_PER_FWHM = 1 / 1.4447034489


def tensors(content: bytes) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """The JSON entry and the arrays of a safetensors file, by numpy alone."""
    (length,) = struct.unpack("<Q", content[:8])
    outer = json.loads(content[8 : 8 + length])
    entry = json.loads(outer.pop("__metadata__")["upglow"])
    dtypes = {"F32": "<f4", "F64": "<f8", "U8": "u1"}
    arrays = {}
    for name, tensor in outer.items():
        first, end = (8 + length + offset for offset in tensor["data_offsets"])
        data = np.frombuffer(content[first:end], dtypes[tensor["dtype"]])
        arrays[name] = data.reshape(tensor["shape"])
    return entry, arrays


def rewritten(content: bytes, **changed: np.ndarray) -> bytes:
    """The file with other arrays of the same shapes, and their checksum."""
    _, arrays = tensors(content)
    arrays |= changed
    (length,) = struct.unpack("<Q", content[:8])
    outer = json.loads(content[8 : 8 + length])
    sha = hashlib.sha256(outer.pop("__metadata__")["upglow"].encode())
    for name in sorted(arrays.keys() - {"sha256"}):
        shape = ",".join(map(str, arrays[name].shape))
        sha.update(f"\n{name} {outer[name]['dtype']} {shape}\n".encode())
        sha.update(arrays[name].tobytes())
    arrays["sha256"] = np.frombuffer(sha.digest(), np.uint8)
    made = bytearray(content)
    for name, tensor in outer.items():
        first, end = (8 + length + offset for offset in tensor["data_offsets"])
        made[first:end] = arrays[name].tobytes()
    return bytes(made)


@dataclass
class Absorber:
    """One absorber and its emitter: c, Q, mean emission, curves."""

    concentration: float
    quantum_yield: float
    mean_nm: float
    absorption: Any
    emission: Any


class Reader:
    """A cube's file."""

    def __init__(self, content: bytes) -> None:
        self.header, self.arrays = tensors(content)
        self.model = self.header["model"]
        self.last = self.header["resolution"] - 1

    def corners(self, rgb: np.ndarray) -> list[tuple[float, tuple[int, int, int]]]:
        """Weights and nodes (red, green, blue) around a color."""
        low = np.minimum((rgb * self.last).astype(int), self.last - 1)
        fraction = rgb * self.last - low
        nodes = [low]
        order = np.argsort(-fraction, kind="stable")
        for axis in order:
            nodes.append(nodes[-1] + np.eye(3, dtype=int)[axis])
        weights = -np.diff([1, *fraction[order], 0])
        return [(w, tuple(n)) for w, n in zip(weights, nodes, strict=True)]

    def bare(self, node: tuple[int, int, int], nm: np.ndarray) -> np.ndarray:
        """The reflectance of a node without absorption by dyes."""
        r, g, b = node
        edge, level, slope = self.arrays["reflectance"][b, g, r].astype(float)
        d, t = nm - edge, 1 + level**2
        x = level + 2 * slope * t**1.5 * d + 6 * slope**2 * level * t**2 * d**2
        return 0.5 + x / (2 * np.sqrt(1 + x * x))

    def absorbers(self, node: tuple[int, int, int]) -> list[Absorber]:
        """The absorbers and emitters of a node."""
        if self.model["kind"] == "reflectance":
            return []
        r, g, b = node
        first, second, third = self.arrays["fluorescence"][b, g, r].astype(float)
        if self.model["kind"] == "analytic":
            return [self.bells(first, second, third)] if third > 0 else []
        if self.model["kind"] == "film":
            return self.film(self.arrays["dyes"][b, g, r], np.array([first, second]))
        number = int(self.arrays["dyes"][b, g, r, 0])
        return self.dyes(number, first, second) if second > 0 else []

    def bells(self, peak_nm: float, shift_nm: float, concentration: float) -> Absorber:
        def spline(nm: np.ndarray, center: float, step: float) -> np.ndarray:
            u = np.abs(nm - center) / step
            near, far = 2 / 3 - u**2 + u**3 / 2, (2 - u) ** 3 / 6
            return np.where(u < 1, near, np.where(u < 2, far, 0))

        wide = self.model["absorption_fwhm_nm"] * KNOT_STEP_PER_FWHM
        narrow = self.model["emission_fwhm_nm"] * KNOT_STEP_PER_FWHM
        return Absorber(
            concentration,
            float(self.model["quantum_yield"]),
            peak_nm,
            lambda nm: 1.5 * spline(nm, peak_nm - shift_nm, wide),
            lambda nm: spline(nm, peak_nm, narrow) / narrow,
        )

    def dyes(self, number: int, weight: float, concentration: float) -> list[Absorber]:
        curves = self.arrays["dye_curves"]
        absorption, emission = curves[:, 0], curves[:, 1]
        if density := self.model["optical_density"]:
            absorption = 1 - 10 ** (-density * absorption)
        emission = emission / emission.sum(axis=1, keepdims=True)
        yields = [self.quantum_yield(dye) for dye in self.model["dyes"]]
        means = emission @ NM
        pair = [number, (number + 1) % len(curves)]
        shares = np.array([1 - weight, weight])

        def absorber(weights: np.ndarray, concentration: float) -> Absorber:
            a, e = weights @ absorption[pair], weights @ emission[pair]
            return Absorber(
                concentration,
                weights @ [yields[i] for i in pair],
                weights @ means[pair],
                lambda nm: np.interp(nm, NM, a, left=0, right=0),
                lambda nm: np.interp(nm, NM, e, left=0, right=0),
            )

        if self.model["mixing"] == "pooled":
            return [absorber(shares, concentration)]
        return [absorber(np.eye(2)[k], concentration * shares[k]) for k in range(2)]

    def film(self, pair: np.ndarray, densities: np.ndarray) -> list[Absorber]:
        """The dyes of a film: of what is absorbed, each has its share of the optical density."""
        absorption, emission = np.moveaxis(self.arrays["dye_curves"][pair], 1, 0)
        emission = emission / emission.sum(axis=1, keepdims=True)
        means = emission @ NM

        def absorbed(nm: np.ndarray, k: int) -> np.ndarray:
            own = [
                density * np.interp(nm, NM, curve, left=0, right=0)
                for density, curve in zip(densities, absorption, strict=True)
            ]
            whole = own[0] + own[1]
            share = np.divide(own[k], whole, out=np.zeros_like(whole), where=whole > 0)
            return share * -np.expm1(-np.log(10) * whole)

        return [
            Absorber(
                1.0,
                self.quantum_yield(self.model["dyes"][pair[k]]),
                means[k],
                lambda nm, k=k: absorbed(nm, k),
                lambda nm, k=k: np.interp(nm, NM, emission[k], left=0, right=0),
            )
            for k in range(2)
            if densities[k] > 0
        ]

    def quantum_yield(self, dye: dict[str, Any]) -> float:
        if self.model["quantum_yield"] != "measured":
            return float(self.model["quantum_yield"])
        return 1.0 if dye["quantum_yield"] is None else dye["quantum_yield"]

    def share(self, in_nm: np.ndarray, mean_nm: float) -> np.ndarray:
        if self.model["accounting"] == "energy":
            return np.ones_like(in_nm)
        return np.minimum(1, in_nm / mean_nm)

    def reflectance(self, rgb: np.ndarray, nm: np.ndarray) -> np.ndarray:
        """Reflectance of a color's material."""
        total = np.zeros_like(nm)
        for weight, node in self.corners(rgb):
            absorbed = sum(
                (k.concentration * k.absorption(nm) for k in self.absorbers(node)), np.zeros(1)
            )
            total += weight * (1 - absorbed) * self.bare(node, nm)
        return total

    def reradiation(self, rgb: np.ndarray, in_nm: np.ndarray, out_nm: np.ndarray) -> np.ndarray:
        """Energy re-radiated per nm at `out_nm`, per unit of energy incident at `in_nm`; 1/nm."""
        total = np.zeros(np.broadcast_shapes(in_nm.shape, out_nm.shape))
        for weight, node in self.corners(rgb):
            for k in self.absorbers(node):
                back = k.concentration * k.quantum_yield * k.absorption(in_nm)
                total += weight * back * self.share(in_nm, k.mean_nm) * k.emission(out_nm)
        return total
