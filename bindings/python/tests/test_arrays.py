"""Shapes, types, colors outside the cube, threads."""

from __future__ import annotations

import threading
import time

import numpy as np
import pytest

import upglow

# Single precision of numbers up to 1, and of densities up to 0.05 per nm.
SINGLE = 1e-5
SINGLE_PER_NM = 1e-6

LEADS = [(), (1,), (7,), (3, 4), (2, 0), (2, 3, 2)]


@pytest.mark.parametrize("lead", LEADS)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_results_keep_the_leading_shape(cube, rng, lead, dtype) -> None:
    rgb = rng.random((*lead, 3)).astype(dtype)
    nm = np.linspace(400, 700, 5)
    assert cube.xyz(rgb).shape == cube.rgb_under(rgb, "A").shape == (*lead, 3)
    for call in (cube.reflectance, cube.albedo):
        assert call(rgb, nm).shape == (*lead, 5)
        assert np.shape(call(rgb, 550.0)) == lead
        assert call(rgb, nm).dtype == dtype
        assert call(rgb, []).shape == (*lead, 0)
    assert np.shape(cube.reradiation(rgb, 500.0, 550.0)) == lead
    assert cube.reradiation_matrix(rgb, [500, 550, 600]).shape == (*lead, 3, 3)
    assert cube.radiance_factor(rgb, [500, 550, 600]).shape == (*lead, 3)
    for array in cube.sample_incident(rgb, 560.0, rng.random((*lead, 2))):
        assert np.shape(array) == lead
    assert cube.material(rgb).shape == lead
    assert cube.fit(rgb).shape == lead
    assert cube.check(rgb).de2000.shape == upglow.standing(rgb).kind.shape == lead
    assert cube.corners(rgb).nodes.shape == (*lead, 4, 3)


def test_arguments_broadcast(cube, rng) -> None:
    rgb, nm = rng.random((4, 1, 3)), np.linspace(400, 700, 5)
    table = cube.reradiation(rgb, 480.0, nm)
    assert table.shape == (4, 5)
    assert table[2, 3] == cube.reradiation(rgb[2, 0], 480.0, nm[3])
    one = cube.sample_outgoing([0.9, 0.1, 0.8], 480.0, rng.random((6, 2)))
    assert one.nm.shape == (6,)


def test_slices_and_other_memory_layouts_give_the_same_results(cube, rng) -> None:
    rgb = rng.random((6, 8, 3))
    assert np.array_equal(cube.xyz(rgb[::2, ::-1]), cube.xyz(rgb)[::2, ::-1])
    planes = np.asfortranarray(rgb)
    assert np.array_equal(cube.reflectance(planes, 500.0), cube.reflectance(rgb, 500.0))
    assert np.array_equal(cube.xyz(rgb.astype(">f4")), cube.xyz(rgb.astype("<f4")))
    assert np.array_equal(cube.xyz([[0, 1, 0], [1, 1, 1]]), cube.xyz([[0.0, 1, 0], [1, 1, 1.0]]))


def test_single_precision_agrees_with_double(any_cube, rng) -> None:
    single = rng.random((200, 3), dtype=np.float32)
    double, nm = single.astype(np.float64), np.linspace(310.0, 820.0, 23)
    for call in (any_cube.reflectance, any_cube.albedo):
        assert np.abs(call(single, nm) - call(double, nm)).max() < SINGLE
    incident, outgoing = 500.0, np.float64(560.0)
    found, expected = (any_cube.reradiation(a, incident, outgoing) for a in (single, double))
    assert np.abs(found - expected).max() < SINGLE_PER_NM
    assert np.array_equal(
        any_cube.reradiation_matrix(single, [450, 500]), any_cube.reradiation_matrix(double, [450, 500])
    )


def test_corners_are_the_nodes_that_are_mixed(cube, rng) -> None:
    rgb, nm = rng.random((30, 3)), np.linspace(400, 700, 7)
    nodes, weights = cube.corners(rgb)
    materials = cube.nodes[tuple(np.moveaxis(nodes, -1, 0))]
    assert materials.shape == (30, 4)
    mixed = (weights[..., None] * cube.reflectance(materials, nm)).sum(axis=1)
    # Rounding only.
    assert np.abs(mixed - cube.reflectance(rgb, nm)).max() < 1e-12
    assert np.allclose(weights.sum(axis=-1), 1.0)


def test_the_difference_of_a_node_is_the_stored_one(cube: upglow.Cube) -> None:
    blue, green, red = np.indices((9, 9, 9))
    rgb = np.stack([red, green, blue], axis=-1) / 8
    # The color is rounded to single precision, which near black is a larger difference.
    assert np.abs(cube.check(rgb).de2000 - cube.nodes.de2000).max() < 1e-3


def test_polished_materials_are_single_ones_near_the_color(cube, rng) -> None:
    rgb = rng.random((500, 3), dtype=np.float32)
    materials = cube.material(rgb)
    assert materials.shape == (500,) and materials.model == "dyes"
    assert np.all((materials.concentration >= 0) & (materials.concentration <= 1))
    # The cube's limit, and single precision.
    assert np.abs(materials.slope_per_nm).max() <= 0.01 * (1 + 1e-6)
    albedo = cube.albedo(materials, upglow.FIT_NM)
    assert albedo.max() <= 1 + 1e-9 and albedo.min() >= 0
    assert materials[3].edge_nm == materials.edge_nm[3]
    assert materials[..., 3].level == materials.level[3]


def test_the_columns_of_stored_numbers_have_names(any_cube: upglow.Cube) -> None:
    nodes = any_cube.nodes
    names = {
        "reflectance": [None, "concentration", None],
        "dyes": ["weight", "concentration", None],
        "film": [None, None, None],
        "analytic": ["emission_peak_nm", "stokes_shift_nm", "concentration"],
    }
    for column, name in enumerate(["edge_nm", "level", "slope_per_nm"]):
        assert np.array_equal(getattr(nodes, name), nodes.reflectance[..., column])
    for column, name in enumerate(names[nodes.model]):
        if name is not None:
            assert np.array_equal(getattr(nodes, name), nodes.fluorescence[..., column])
    for name in {"weight", "emission_peak_nm", "stokes_shift_nm"} - set(names[nodes.model]):
        with pytest.raises(AttributeError, match=f"materials of the model {nodes.model} have no"):
            getattr(nodes, name)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_colors_outside_are_refused_with_index_and_value(cube, dtype) -> None:
    rgb = np.full((2, 3, 3), 0.5, dtype=dtype)
    rgb[1, 2, 1] = 1.25
    message = r"^rgb\[1, 2\]: green is 1.25, expected 0 to 1, the range of the cube$"
    for call in (
        cube.xyz,
        cube.material,
        cube.corners,
        lambda a: cube.rgb_under(a, "A"),
        lambda a: cube.relight(a, ["A"]),
        lambda a: cube.reflectance(a, 500.0),
        lambda a: cube.albedo(a, 500.0),
        lambda a: cube.reradiation(a, 500.0, 550.0),
        lambda a: cube.reradiation_matrix(a),
        lambda a: cube.sample_incident(a, 500.0, [0.5, 0.5]),
        lambda a: cube.incident_pdf_per_nm(a, 500.0, 550.0),
        lambda a: cube.outgoing_elastic_probability(a, 500.0),
    ):
        with pytest.raises(ValueError, match=message):
            call(rgb)
    with pytest.raises(ValueError, match="^rgb: blue is NaN, expected 0 to 1"):
        cube.xyz([0.5, 0.5, np.nan])
    with pytest.raises(ValueError, match="^rgb: red is -1, expected 0 to 10$"):
        cube.fit([-1, 0, 0])


def test_colors_outside_may_give_nan_or_be_clipped(cube) -> None:
    rgb = np.array([[0.5, 0.5, 0.5], [1.5, -0.5, 0.5], [np.nan, 0.0, 0.0]])
    near = [1.0, 0.0, 0.5]
    for call in (
        lambda a, **k: cube.xyz(a, **k),
        lambda a, **k: cube.reflectance(a, [450.0, 550.0], **k),
        lambda a, **k: cube.reflectance(np.float32(a), [450.0, 550.0], **k),
        lambda a, **k: cube.reradiation(a, 480.0, 550.0, **k),
        lambda a, **k: cube.reradiation_matrix(a, [450, 550], **k),
        lambda a, **k: cube.sample_incident(a, 560.0, [0.9, 0.5], **k).throughput,
        lambda a, **k: cube.material(a, **k).reflectance,
        lambda a, **k: cube.corners(a, **k).weights,
    ):
        refused = np.isnan(call(rgb, outside="nan")).reshape(3, -1)
        assert np.array_equal(refused.all(axis=1), [False, True, True])
        assert not refused[0].any()
        clipped = call(rgb, outside="clip")
        assert np.allclose(clipped[1], call(near), rtol=1e-6, atol=1e-9)
        assert np.isnan(clipped[2]).all()
    with pytest.raises(ValueError, match="outside is 'x', expected raise, nan or clip"):
        cube.xyz(rgb, outside="x")


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda c: c.xyz([0.1, 0.2]), ValueError, r"rgb has shape \(2,\), expected \(..., 3\)"),
        (lambda c: c.xyz(0.1), ValueError, r"rgb has shape \(\), expected"),
        (lambda c: c.xyz(["a"] * 3), TypeError, "rgb has dtype <U1, expected numbers"),
        (lambda c: c.xyz([0.1, 0.2, 0.3j]), TypeError, "rgb has dtype complex128"),
        (lambda c: c.xyz([0, 0, 0], scale="x"), ValueError, 'scale "x", expected white or power'),
        (lambda c: c.xyz([0, 0, 0], step_nm=2), ValueError, "step_nm is 2, expected 1 or 5"),
        (lambda c: c.xyz([0, 0, 0], threads=0), ValueError, "threads is 0, expected 1 to 1024"),
        (lambda c: c.reflectance([0, 0, 0], [[1.0]]), ValueError, "wavelengths_nm has shape"),
        (lambda c: c.reradiation_matrix([0, 0, 0], [1, 2, 4]), ValueError, "rise in equal steps"),
        (lambda c: c.reradiation_matrix([0, 0, 0], [1.5, 2]), ValueError, "whole nm"),
        (lambda c: c.radiance_factor([0, 0, 0], [200, 300]), ValueError, "within 300 to 830 nm"),
        (lambda c: c.sample_incident([0, 0, 0], 500, 0.5), ValueError, "u has shape"),
        (lambda c: c.sample_incident([0, 0, 0], 500, [1, 0]), ValueError, "not in 0 to 1"),
        (lambda c: c.verify(interpolation="x", points=1), ValueError, "unknown interpolation"),
        (lambda c: upglow.standing([np.inf, 0, 0]), ValueError, "not finite"),
        (lambda c: upglow.Cube(), TypeError, "upglow.build, Cube.read or Cube.from_bytes"),
    ],
)
def test_wrong_arguments_are_refused(cube, call, error, message) -> None:
    with pytest.raises(error, match=message):
        call(cube)


UNITS = [(0.55, "µm"), (5.5e-7, "m"), (5500.0, "Å")]


@pytest.mark.parametrize(("wrong", "unit"), UNITS)
def test_wavelengths_in_other_units_are_refused(cube, wrong: float, unit: str) -> None:
    gray, u = [0.5, 0.5, 0.5], [0.5, 0.5]
    expected = f"_nm is {wrong:g}, expected nm, 100 to 4000; it looks like {unit}$"
    for call in (
        lambda nm: cube.reflectance(gray, nm),
        lambda nm: cube.albedo(gray, [nm, nm]),
        lambda nm: cube.reradiation(gray, nm, 550),
        lambda nm: cube.reradiation(gray, 450, nm),
        lambda nm: cube.sample_incident(gray, nm, u),
        lambda nm: cube.sample_outgoing(gray, nm, u),
        lambda nm: cube.incident_pdf_per_nm(gray, nm, 550),
        lambda nm: cube.outgoing_pdf_per_nm(gray, 450, nm),
        lambda nm: cube.incident_elastic_probability(gray, nm),
        lambda nm: cube.outgoing_elastic_probability(gray, nm),
        lambda nm: upglow.Illuminant(([nm, 2 * nm], [1, 1])),
        lambda nm: upglow.Observer(([nm, 2 * nm], np.ones((2, 3)))),
    ):
        with pytest.raises(ValueError, match=expected):
            call(wrong)


def test_whole_numbers_that_are_no_nm_are_refused_and_nan_stays(cube) -> None:
    for call in (cube.reradiation_matrix, cube.radiance_factor):
        with pytest.raises(ValueError, match="wavelengths_nm is 5000, expected nm, 100 to 4000"):
            call([0.5, 0.5, 0.5], [5000, 5010])
    with pytest.raises(ValueError, match="expected nm"):
        cube.reflectance([0.5, 0.5, 0.5], np.inf)
    # Draws give NaN where the light is absorbed, which may be asked about.
    assert np.shape(cube.reradiation([0.5, 0.5, 0.5], [np.nan, 450], 550)) == (2,)


def test_masked_arrays_are_refused(cube) -> None:
    def masked(values):
        array = np.ma.array(np.asarray(values, dtype=np.float64))
        array[..., 0] = np.ma.masked
        return array

    rgb, nm = masked([[0.5, 0.5, 0.5]]), masked([450.0, 550.0])
    gray = [0.5, 0.5, 0.5]
    for call in (
        lambda: cube.xyz(rgb),
        lambda: cube.material(rgb),
        lambda: cube.fit(rgb),
        lambda: cube.check([rgb[0], gray]),
        lambda: upglow.standing(rgb),
        lambda: cube.reflectance(gray, nm),
        lambda: cube.reradiation(gray, nm, 550),
        lambda: cube.reradiation_matrix(gray, nm),
        lambda: cube.sample_incident(gray, 500, masked([0.5, 0.5])),
        lambda: upglow.Illuminant((nm, [1, 1])),
        lambda: upglow.Illuminant(([450, 550], masked([1, 1]))),
    ):
        with pytest.raises(TypeError, match="is a masked array, expected one without mask"):
            call()


def test_materials_of_another_model_are_refused(cube) -> None:
    others = [
        upglow.build(model=upglow.Dyes(set="wide14"), resolution=2),
        upglow.build(preset="konig2020", model=upglow.Dyes(accounting="photon"), resolution=2),
        upglow.build(model=upglow.Reflectance(), resolution=2),
    ]
    for materials in (other.nodes[0, 0] for other in others):
        for ask in (
            lambda of: cube.reflectance(of, 500.0),
            lambda of: cube.albedo(of, [500.0]),
            lambda of: cube.reradiation(of, 500.0, 600.0),
            lambda of: cube.reradiation_matrix(of),
            lambda of: cube.sample_incident(of, 500.0, [0.5, 0.5]),
        ):
            with pytest.raises(ValueError, match="^materials of another cube: their model is "):
                ask(materials)
    with pytest.raises(ValueError, match=r"model is reflectance [0-9a-f]{8}, expected dyes [0-9a-f]{8}$"):
        cube.albedo(others[2].nodes, 500.0)


def test_materials_are_taken_by_cubes_of_the_same_model(cube) -> None:
    light = upglow.Contract(illuminant="A")
    other = upglow.build(light, preset="konig2020", resolution=2)
    assert np.array_equal(cube.albedo(other.nodes, 500.0), other.albedo(other.nodes, 500.0))


def test_materials_of_ones_own_numbers_are_taken_as_the_cubes(cube) -> None:
    of = cube.nodes
    arrays = dict(reflectance=of.reflectance, fluorescence=of.fluorescence, de2000=of.de2000)
    own = upglow.Materials(**arrays, dyes=of.dyes, model="dyes")
    assert own.model_id is None
    assert np.array_equal(cube.albedo(own, 500.0), cube.albedo(of, 500.0))
    # A dye that the set does not have is no material.
    unknown = upglow.Materials(**arrays, dyes=of.dyes + np.uint8(200), model="dyes")
    fluoresces = of.concentration > 0
    assert fluoresces.any()
    assert np.isnan(cube.albedo(unknown, 500.0))[fluoresces].all()
    with pytest.raises(ValueError, match="their model is film, expected dyes"):
        cube.albedo(upglow.Materials(**arrays, dyes=of.dyes, model="film"), 500.0)


def test_results_do_not_depend_on_threads(cube, rng) -> None:
    rgb, nm = rng.random((40_000, 3)), np.linspace(400, 700, 4)
    single, u = rgb.astype(np.float32), rng.random((40_000, 2))
    calls = [
        lambda n: cube.xyz(rgb, threads=n),
        lambda n: cube.rgb_under(rgb, "A", threads=n),
        lambda n: cube.relight(rgb, ["D65", "A"], threads=n).lab,
        lambda n: cube.reflectance(rgb, nm, threads=n),
        lambda n: cube.reflectance(single, nm, threads=n),
        lambda n: cube.albedo(single, nm, threads=n),
        lambda n: cube.reradiation(single, 500.0, 560.0, threads=n),
        lambda n: np.stack(cube.sample_incident(rgb, 560.0, u, threads=n)),
        lambda n: cube.material(single[:4000], threads=n).reflectance,
        lambda n: cube.check(rgb[:2000], threads=n).de2000,
        lambda n: np.stack(upglow.standing(rgb[:2000], threads=n)),
        lambda n: cube.fit(rgb[:100], threads=n).reflectance,
    ]
    for call in calls:
        assert np.array_equal(call(1), call(3))
    cut = np.concatenate([cube.xyz(part) for part in np.array_split(rgb, 7)])
    assert np.array_equal(cut, cube.xyz(rgb))


def test_pythons_lock_is_released_while_rust_works(cube, rng) -> None:
    rgb, nm = rng.random((20_000, 3)), np.linspace(300, 830, 200)
    started, finished = threading.Event(), threading.Event()

    def work() -> None:
        started.set()
        cube.reflectance(rgb, nm, threads=1)
        finished.set()

    worker = threading.Thread(target=work)
    start = time.perf_counter()
    worker.start()
    started.wait()
    ticks, longest, last = 0, 0.0, time.perf_counter()
    while not finished.is_set():
        time.sleep(0.001)
        now = time.perf_counter()
        ticks, longest, last = ticks + 1, max(longest, now - last), now
    worker.join()
    took = time.perf_counter() - start
    # If the lock were held, this thread would make no progress meanwhile.
    assert ticks > 10 and longest < 0.5 * took, (ticks, longest, took)
