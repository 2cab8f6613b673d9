"""Building cubes: options, progress, Ctrl-C, threads."""

from __future__ import annotations

import threading
import warnings
from typing import Any

import numpy as np
import pytest

import upglow


def test_the_cube_does_not_depend_on_the_number_of_threads() -> None:
    one, three = (upglow.build(resolution=5, threads=n).to_bytes() for n in (1, 3))
    assert one == three


def test_the_header_has_the_options() -> None:
    cube = upglow.build(
        upglow.Contract(space="rec2020", illuminant="D50", adaptation="none"),
        model=upglow.Analytic(absorption_fwhm_nm=40.0),
        resolution=3,
        slope_max_per_nm=0.02,
        metric="de76",
        method="exhaustive",
        sweeps=1,
    )
    header = cube.header
    assert header["contract"]["rgb_space"] == "rec2020"
    assert header["contract"]["illuminant"] == "D50"
    assert header["contract"]["adaptation"] == "none"
    assert header["model"]["absorption_fwhm_nm"] == 40.0
    fit = {"metric": "de76", "method": "exhaustive", "slope_max_per_nm": 0.02, "sweeps": 1}
    assert header["fit"].items() >= fit.items()
    assert upglow.build(resolution=2, slope_max_per_nm=None).header["fit"]["slope_max_per_nm"] is None


def test_a_preset_is_recorded_and_other_arguments_override_it() -> None:
    def recorded(**options: Any) -> tuple[Any, ...]:
        header = upglow.build(resolution=2, **options).header
        names = "preset", "slope_max_per_nm", "slope_under_dyes_per_nm", "relaxed"
        return header["model"]["kind"], *(header["fit"][name] for name in names)

    natural = recorded(preset="natural")
    assert natural[:2] == ("film", "natural") and natural[2] > natural[3] and natural[4] is True
    assert recorded() == natural
    assert recorded(preset="konig2020") == ("dyes", "konig2020", 0.01, 0.01, False)
    assert recorded(preset="jung2019") == ("analytic", "jung2019", 0.01, 0.01, False)
    assert recorded(preset="jakob2019") == ("reflectance", "jakob2019", None, None, False)
    assert recorded(preset="konig2020", slope_max_per_nm=0.02)[1:4] == (None, 0.02, 0.02)
    assert recorded(preset="natural", slope_under_dyes_per_nm=0.01)[1:4] == (None, natural[2], 0.01)
    assert recorded(preset="natural", relaxed=False)[4] is False
    with pytest.raises(ValueError, match="unknown preset"):
        upglow.build(preset="paint")


def test_kinds_of_material_add_up(any_cube: upglow.Cube) -> None:
    summary = any_cube.summary()
    assert sum(summary.kinds.values()) == summary.nodes
    assert summary.kinds["missed"] == summary.nodes - summary.exact


def test_a_film_has_dyes_and_densities() -> None:
    nodes = upglow.build(preset="natural", resolution=4).nodes
    assert nodes.dyes.shape == (4, 4, 4, 2) and nodes.densities.shape == (4, 4, 4, 2)
    assert np.all(nodes.densities[..., 0] >= nodes.densities[..., 1])
    assert np.array_equal(nodes.dose, nodes.densities.sum(axis=-1)) and nodes.dose.max() > 0
    with pytest.raises(AttributeError, match="have no concentration"):
        _ = nodes.concentration


def test_every_stage_reports_progress_to_its_end() -> None:
    told: list[tuple[str, int, int]] = []
    upglow.build(resolution=5, progress=lambda *step: told.append(step))
    assert told[-1] == ("measuring", 125, 125)
    assert all(0 <= done <= total for _, done, total in told)


def test_progress_is_reported_on_the_calling_thread() -> None:
    threads = set()
    upglow.build(resolution=5, progress=lambda *_: threads.add(threading.get_ident()))
    assert threads == {threading.get_ident()}


def test_a_bar_is_drawn_where_tqdm_is(capsys: pytest.CaptureFixture[str]) -> None:
    with warnings.catch_warnings():
        # Outside notebooks tqdm.auto warns that it has no widgets.
        warnings.simplefilter("ignore")
        upglow.build(resolution=5, progress=True)
    assert "measuring: 100%" in capsys.readouterr().err


def test_without_tqdm_there_is_no_bar_but_a_cube(monkeypatch, capsys) -> None:
    monkeypatch.setitem(__import__("sys").modules, "tqdm.auto", None)
    assert upglow.build(resolution=2, progress=True).resolution == 2
    assert capsys.readouterr().err == ""


def test_an_exception_in_progress_stops_the_build() -> None:
    def tired(*_: object) -> None:
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        upglow.build(resolution=64, progress=tired)


def test_a_fit_is_at_least_as_good_as_a_polished_material(cube: upglow.Cube) -> None:
    rgb = np.array([[0.9, 0.1, 0.8], [0.2, 0.6, 0.3], [0.7, 0.6, 0.2]])
    # The tolerance for a match; single precision has a smaller error.
    matched = 0.01
    assert np.all(cube.fit(rgb).de2000 <= cube.material(rgb).de2000 + matched)


def test_a_fit_is_flat_for_gray_and_accepts_colors_brighter_than_white(cube) -> None:
    assert cube.fit([0.5, 0.5, 0.5]).concentration == 0
    orange = cube.fit([1.3, 0.4, 0.05])
    assert orange.concentration > 0
    assert cube.albedo(orange, upglow.FINE_NM).max() <= 1 + 1e-9


def test_nodes_are_what_fit_finds_for_gray(cube: upglow.Cube) -> None:
    gray = cube.fit([0.5, 0.5, 0.5])
    node = cube.nodes[4, 4, 4]
    assert np.array_equal(gray.reflectance, node.reflectance)


def test_former_words_are_still_read() -> None:
    def content(**options) -> bytes:
        return upglow.build(preset="konig2020", resolution=2, **options).to_bytes()

    assert content(model=upglow.Dyes(set="seed8")) == content(model=upglow.Dyes(set="konig8"))
    for former, word in [("seed", "konig2020"), ("seed-features", "konig2020-features")]:
        assert content(method=former) == content(method=word)


def test_unmeasured_yields_are_a_warning() -> None:
    with pytest.warns(UserWarning, match="no published quantum yield, taken as 1: "):
        upglow.build(model=upglow.Dyes(quantum_yield="measured"), resolution=2)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"resolution": 1}, "resolution 1, expected 2 to 256"),
        ({"slope_max_per_nm": 1.0}, "slope limit 1/nm, expected 0.0001 to 0.2/nm"),
        ({"metric": "de94"}, 'unknown metric "de94", expected de2000, de76 or rgb'),
        (
            {"method": "x"},
            'unknown method "x", expected search, exhaustive, konig2020 or konig2020-features',
        ),
        ({"threads": 0}, "threads is 0, expected 1 to 1024"),
        ({"model": upglow.Dyes(mixing="x")}, 'unknown mixing "x", expected pooled or separate'),
        ({"model": upglow.Dyes(quantum_yield=2.0)}, "quantum yield 2, expected 0 to 1"),
        ({"model": upglow.Film(quantum_yield=2.0)}, "quantum yield 2, expected 0 to 1"),
        ({"model": upglow.Film(accounting="x")}, 'unknown accounting "x", expected energy or photon'),
        ({"model": upglow.Film(set="x")}, 'unknown dye set "x", expected konig8, open8, wide14, wide8 or'),
        (
            {"model": upglow.Film(normalize=True)},
            "normalize with the set 'wide8', expected a folder or a list",
        ),
        ({"model": upglow.Dyes(optical_density=0)}, "optical density 0, expected > 0"),
        ({"model": upglow.Dyes(set="x")}, 'unknown dye set "x", expected konig8, open8, wide14, wide8 or'),
        ({"model": upglow.Analytic(emission_fwhm_nm=5)}, "width 5 nm, expected 15 to 80 nm"),
    ],
)
def test_a_wrong_option_is_refused_with_what_was_expected(options, message) -> None:
    with pytest.raises(ValueError) as found:
        upglow.build(**{"resolution": 2} | options)
    assert str(found.value).startswith(message)


def test_dyes_come_from_a_folder_or_from_arrays(tmp_path) -> None:
    nm = np.arange(300.0, 831.0, 5.0)

    def bell(center: float) -> np.ndarray:
        return np.exp(-(((nm - center) / 30.0) ** 2))

    for name, center in (("a", 450.0), ("b", 560.0)):
        rows = "\n".join(f"{n},{x},{y}" for n, x, y in zip(nm, bell(center), bell(center + 40)))
        (tmp_path / f"{name}.csv").write_text(f"wavelength_nm,absorption,emission\n{rows}\n")
    folder = upglow.Dyes(set=tmp_path)
    order = folder.names()
    center = {"a": 450.0, "b": 560.0}
    arrays = upglow.Dyes(
        set=[
            upglow.Dye(name=n, absorption=(nm, bell(center[n])), emission=(nm, bell(center[n] + 40)))
            for n in order
        ]
    )
    cubes = [upglow.build(model=model, resolution=3) for model in (folder, arrays)]
    assert np.array_equal(cubes[0].dye_curves, cubes[1].dye_curves)
    assert np.array_equal(cubes[0].nodes.fluorescence, cubes[1].nodes.fluorescence)
    with pytest.raises(ValueError, match="dye x: covers 400 to 500 nm, expected at least"):
        short = (np.arange(400.0, 501.0), np.ones(101))
        upglow.Dyes(set=[upglow.Dye(name="x", absorption=short, emission=short)]).names()
    with pytest.raises(FileNotFoundError):
        upglow.Dyes(set=tmp_path / "none").names()


def test_dyes_are_normalized_on_request_and_have_names_and_yields_of_their_own() -> None:
    nm = np.arange(300.0, 831.0, 5.0)

    def bell(center: float) -> np.ndarray:
        return np.exp(-(((nm - center) / 30.0) ** 2))

    def ring(name: str = "a", scale: float = 1.0, shift: float = 40.0, quantum_yield=None) -> list:
        curves = {"absorption": (nm, scale * bell(450)), "emission": (nm, bell(450 + shift))}
        return [upglow.Dye(name=name, quantum_yield=quantum_yield, **curves)]

    # A power of two, so that the quotient is exact.
    scaled = upglow.Dyes(set=ring(scale=128.0), normalize=True)
    cubes = [upglow.build(model=m, resolution=2) for m in (scaled, upglow.Dyes(set=ring()))]
    assert np.array_equal(cubes[0].dye_curves, cubes[1].dye_curves)
    for dyes, message in (
        (ring(scale=128.0), "dye a: the absorption peaks at 128, expected a peak in 0..1"),
        (ring(shift=-40.0), "dye a: the emission's mean wavelength is 410"),
        (ring(quantum_yield=1.5), "dye a: quantum yield 1.5, expected 0 to 1"),
        (ring(name="ATTO_390"), '"ATTO_390" is a built-in dye whose absorption at 300 nm is'),
        (2 * ring(), 'two dyes are called "a", expected different names'),
    ):
        with pytest.raises(ValueError, match=message):
            upglow.Dyes(set=dyes).names()
    with pytest.raises(ValueError, match="normalize with the set 'konig8', expected a folder"):
        upglow.Dyes(normalize=True).names()
