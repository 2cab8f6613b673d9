"""Materials that may have a color, and how far an answer may be off."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import upglow

ORANGE = [0.9, 0.3, 0.02]

# A blend is computed from sums of its weights.
ROUNDING = 1e-12


@pytest.fixture(scope="module")
def orange() -> upglow.Metamers:
    return upglow.metamers(ORANGE, kind="fluorescent")


def test_colors_are_those_of_probable_materials(orange: upglow.Metamers) -> None:
    probability, xyz = orange.colors("A")
    assert xyz.shape == (*probability.shape, 3) and abs(probability.sum() - 1.0) < ROUNDING
    assert np.abs(probability @ xyz - orange.mean("A")).max() < ROUNDING
    # Under the light of the contract all have the color.
    own = upglow.Contract().xyz_from_rgb @ ORANGE
    assert np.abs(orange.mean("D65") - own).max() < 1e-3
    assert orange.band("D65", own) < 0.1 < orange.band("A")
    assert orange.band("A", share=0.5) < orange.band("A", share=0.9) < orange.band("A", share=1.0)
    for answer in ("single", "mixture"):
        seen = getattr(orange, answer).relight(["A"]).xyz[0]
        assert orange.band("A", answer) == orange.band("A", seen) > 0.0


def test_a_blend_is_the_mean_of_its_parts_by_weight(orange: upglow.Metamers) -> None:
    mixture, nm = orange.mixture, np.arange(400.0, 701.0, 20.0)
    assert mixture.weights.shape == mixture.materials.shape and abs(mixture.weights.sum() - 1) < ROUNDING
    assert 1 < mixture.weights.size <= 4 and len(mixture.dye_names) <= 2 * mixture.weights.size
    cube = mixture._blending
    parts = cube.reflectance(mixture.materials, nm)
    assert np.abs(mixture.weights @ parts - mixture.reflectance(nm)).max() < ROUNDING
    factors = cube.radiance_factor(mixture.materials, nm, light="A")
    assert np.abs(mixture.weights @ factors - mixture.radiance_factor(nm, light="A")).max() < ROUNDING
    heaviest = cube.nodes[0, 0, 0]
    assert heaviest == mixture.materials[0] or mixture.weights[0] < mixture.weights.max()


def test_the_cube_of_an_answer_is_the_answer_for_any_color(orange: upglow.Metamers) -> None:
    single, nm = orange.single, np.arange(400.0, 701.0, 20.0)
    cube = upglow.Cube.from_bytes(single.cube().to_bytes())
    for rgb in ([0.1, 0.7, 0.3], [1.0, 1.0, 1.0]):
        assert np.abs(cube.reflectance(rgb, nm) - single.reflectance(nm)).max() < ROUNDING
    assert single.weights.tolist() == [1.0]
    assert np.array_equal(single.reradiation_matrix(), cube.reradiation_matrix([1.0, 1.0, 1.0]))


def test_xyz_is_rgb_of_another_contract(orange: upglow.Metamers) -> None:
    measured = upglow.Contract(space="xyz", adaptation="none")
    own = upglow.Contract().xyz_from_rgb @ ORANGE
    found = upglow.metamers(own, measured, kind="fluorescent")
    # The target is rounded in another place, and a search ends within this.
    assert np.abs(found.mean("A") - orange.mean("A")).max() < 1e-4


def test_a_second_color_decides_whether_a_paint_fluoresces() -> None:
    brown = [0.4, 0.2, 0.05]
    ordinary = upglow.metamers(brown, kind="ordinary")
    light = "D65-cut400"
    # As an ordinary paint looks without ultraviolet, and with a third less red than that.
    (seen,) = ordinary.single.relight([light]).rgb
    dimmer = seen * [0.67, 1.0, 1.0]
    same = upglow.metamers(brown, known={light: seen})
    other = upglow.metamers(brown, known=[(upglow.Illuminant(light), dimmer)])
    assert ordinary.fluorescent_probability < 0.1
    assert same.fluorescent_probability < 0.1 and other.fluorescent_probability > 0.9
    # How ordinary paint looks without ultraviolet tells little; how it looks under A, much.
    (under_a,) = ordinary.single.relight(["A"]).rgb
    assert upglow.metamers(brown, known={"A": under_a}).band("A") < 0.5 * same.band("A")
    assert ordinary.single.relight([light]).fluorescent_share[0] == 0.0


def test_an_answer_is_compared_with_a_measured_matrix(orange: upglow.Metamers) -> None:
    nm = np.arange(300.0, 781.0, 10.0)
    gray = upglow.DonaldsonMatrix(nm, nm, 0.5 * np.eye(nm.size), unit="per band")
    found = orange.single.difference(gray, "A")
    # Sums over 10 nm beside those over 5 nm.
    (seen,) = orange.single.relight(["A"]).xyz
    assert np.abs(found.fitted - seen).max() < 0.01
    assert abs(found.measured[1] - 0.5) < ROUNDING and found.de2000 > 10.0


def test_lights_without_ultraviolet_are_told_where_they_were_given() -> None:
    nm = np.arange(300.0, 781.0, 10.0)
    values = 0.5 * np.eye(nm.size)
    values[20, 5] = 0.3
    matrix = upglow.DonaldsonMatrix(nm, nm, values, unit="per band")
    fit = upglow.fit_matrix(matrix)
    fluorescent = upglow.metamers(ORANGE, kind="fluorescent")
    calls: list[Callable[[], Any]] = [
        lambda: matrix.color("FL2"),
        lambda: fit.difference("FL2"),
        lambda: fit.cube().relight([0.5, 0.5, 0.5], ["FL2"]),
        lambda: fit.cube().xyz([0.5, 0.5, 0.5], light="FL2"),
        lambda: fit.cube().radiance_factor([0.5, 0.5, 0.5], light="FL2"),
        lambda: fluorescent.mixture.relight(["FL2"]),
        lambda: fluorescent.mean("FL2"),
        lambda: fluorescent.band("FL2"),
        lambda: upglow.metamers(ORANGE, known={"FL2": [0.8, 0.3, 0.05]}),
    ]
    for call in calls:
        with pytest.warns(UserWarning, match="FL2 is given from 380 nm on") as told:
            call()
        assert {warning.filename for warning in told} == {__file__}
    # Dyes that only absorb hide nothing: a warning would be an error here.
    upglow.metamers([0.4, 0.2, 0.05], kind="ordinary").mean("FL2")


@pytest.mark.parametrize(
    ("changes", "fault"),
    [
        ({"rgb": [[0.5, 0.4, 0.3]]}, r"rgb has shape \(1, 3\), expected one color, \(3,\)"),
        ({"rgb": [0.5, 0.4, np.nan]}, "rgb: blue is NaN, expected 0 to 10"),
        ({"rgb": [11.0, 0.4, 0.3]}, "rgb: red is 11, expected 0 to 10"),
        ({"known": {"A": [0.5, 0.4]}}, r"the color under A has shape \(2,\), expected \(3,\)"),
        ({"known": {"A": [0.5, 0.4, np.inf]}}, "the color under A is .* expected numbers up to 10"),
        ({"known": [("A", [0.5, 0.4, 0.3])] * 3}, "colors under 4 lights, expected at most 3"),
        ({"known": {"X": [0.5, 0.4, 0.3]}}, 'unknown illuminant "X"'),
        ({"kind": "odd"}, "expected any, ordinary or fluorescent"),
        ({"dyes": "odd"}, 'unknown dye set "odd"'),
        ({"threads": 0}, "threads is 0, expected 1 to 1024"),
    ],
)
def test_faults_are_named(changes: dict[str, Any], fault: str) -> None:
    with pytest.raises(ValueError, match=fault):
        upglow.metamers(**({"rgb": [0.5, 0.4, 0.3]} | changes))


def test_bands_have_their_limits(orange: upglow.Metamers) -> None:
    for given, fault in (
        ({"share": 1.5}, "share is 1.5, expected 0 to 1"),
        ({"share": float("nan")}, "share is NaN, expected 0 to 1"),
        ({"answer": "best"}, "answer is 'best', expected mean, single, mixture or X, Y, Z"),
        ({"answer": [0.5, 0.5]}, r"answer has shape \(2,\), expected \(3,\)"),
        ({"answer": [0.5, 0.5, np.nan]}, "answer is .*, expected finite X, Y, Z"),
    ):
        with pytest.raises(ValueError, match=fault):
            orange.band("A", **given)
    cube = upglow.build(model=upglow.Reflectance(), resolution=2)
    with pytest.raises(ValueError, match="1001 colors, expected at most 1000 with band=True"):
        cube.relight(np.full((1001, 3), 0.5), ["A"], band=True)


def test_control_c_stops_bands() -> None:
    cube = upglow.build(model=upglow.Reflectance(), resolution=2)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    main = threading.main_thread().ident
    assert main is not None
    timer = threading.Timer(0.5, lambda: signal.pthread_kill(main, signal.SIGINT))
    started = time.monotonic()
    try:
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            cube.relight(np.full((1000, 3), 0.5), ["A"], band=True)
    finally:
        timer.cancel()
        signal.signal(signal.SIGINT, before)
    # A color takes half a second of two cores; all take minutes.
    assert time.monotonic() - started < 60.0
