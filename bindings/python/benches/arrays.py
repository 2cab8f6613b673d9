"""Colors per second of methods on arrays: ``python benches/arrays.py``.

Prints millions of colors a second, the best of some runs, on all cores and on one. Colors are random,
so that every look-up is somewhere else; the cube is the default one.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from functools import partial

import numpy as np

import upglow

RUNS = 5
NM = np.arange(400.0, 701.0, 10.0)


def best(work: Callable[[], object]) -> float:
    """Seconds of the fastest run, after one that is not counted."""
    work()
    times = []
    for _ in range(RUNS):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times)


def main() -> None:
    """Prints a row for each method."""
    parser = argparse.ArgumentParser(description="Speed of upglow's array calls.")
    parser.add_argument("--colors", type=int, default=4_000_000, help="colors in the array")
    parser.add_argument("--resolution", type=int, default=32, help="nodes along an axis")
    options = parser.parse_args()
    for name, least in (("colors", 1), ("resolution", 2)):
        if (found := getattr(options, name)) < least:
            parser.error(f"--{name} is {found}, expected {least} or more")
    cube = upglow.build(preset="konig2020", resolution=options.resolution)
    double = np.random.default_rng(0).random((options.colors, 3))
    single = double.astype(np.float32)
    few = single[: max(options.colors // 40, 1)]
    u = np.random.default_rng(1).random((len(few), 2)).astype(np.float32)
    questions: list[tuple[str, np.ndarray, Callable[[np.ndarray, int | None], object]]] = [
        ("xyz, float32", single, lambda rgb, t: cube.xyz(rgb, threads=t)),
        ("xyz, float64", double, lambda rgb, t: cube.xyz(rgb, threads=t)),
        ("reflectance, 31 wavelengths", few, lambda rgb, t: cube.reflectance(rgb, NM, threads=t)),
        ("sample_incident", few, lambda rgb, t: cube.sample_incident(rgb, 600.0, u, threads=t)),
    ]
    print(f"{'million colors a second':30} {'all cores':>10} {'one core':>10}")
    for name, rgb, ask in questions:
        rates = [len(rgb) / 1e6 / best(partial(ask, rgb, t)) for t in (None, 1)]
        print(f"{name:30} {rates[0]:10.2f} {rates[1]:10.2f}")


if __name__ == "__main__":
    main()
