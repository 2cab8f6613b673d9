"""Drawn wavelengths: estimates, densities, probabilities."""

from __future__ import annotations

import numpy as np
import pytest

import upglow

MAGENTA = np.array([0.9, 0.1, 0.8])
COUNT = 200_000
# Six standard deviations of the mean of this many draws from 0..1.
NOISE = 6 * 0.5 / COUNT**0.5
# The trapezoid rule over 1 nm, for curves whose slope changes at every nm.
QUADRATURE = 2e-3


def integral(density: np.ndarray, nm: np.ndarray) -> float:
    return float((np.diff(nm) * (density[1:] + density[:-1])).sum() / 2)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_draws_follow_their_density(any_cube, rng, dtype) -> None:
    rgb = MAGENTA.astype(dtype)
    edges = np.linspace(280.0, 850.0, 58)
    nm = np.arange(280.0, 850.25, 0.25)
    for draw, pdf, elastic, known in (
        (
            any_cube.sample_incident,
            lambda at: any_cube.incident_pdf_per_nm(rgb, at, 600.0),
            any_cube.incident_elastic_probability(rgb, 600.0),
            600.0,
        ),
        (
            any_cube.sample_outgoing,
            lambda at: any_cube.outgoing_pdf_per_nm(rgb, 480.0, at),
            any_cube.outgoing_elastic_probability(rgb, 480.0),
            480.0,
        ),
    ):
        found = draw(rgb, known, rng.random((COUNT, 2)))
        assert abs(found.is_elastic.mean() - elastic) < NOISE
        assert np.all(found.nm[found.is_elastic] == dtype(known))
        shifted = found.nm[~found.is_elastic]
        density = pdf(nm).astype(np.float64)
        assert abs(elastic + integral(density, nm) - 1.0) < QUADRATURE
        cumulative = np.concatenate(
            [[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(nm))]
        )
        expected = np.diff(np.interp(edges, nm, cumulative))
        drawn = np.histogram(shifted, edges)[0] / COUNT
        assert np.abs(drawn - expected).max() < NOISE + QUADRATURE / 10
        # The density of a sample is that of its wavelength.
        again = pdf(shifted[:100].astype(np.float64))
        assert np.allclose(found.pdf[~found.is_elastic][:100], again, rtol=1e-3, atol=1e-7)


def test_throughput_is_the_materials_value_over_all_wavelengths(any_cube, rng) -> None:
    in_nm = 480.0
    found = any_cube.sample_outgoing(MAGENTA, in_nm, rng.random((100, 2)))
    # Emissions that end above zero lose a little outside their tables.
    assert np.allclose(found.throughput, any_cube.albedo(MAGENTA, in_nm), atol=1e-3)
    r = any_cube.reflectance(MAGENTA, in_nm)
    kept = found.is_elastic
    assert np.allclose(found.throughput[kept] * found.pdf[kept], r, rtol=1e-9)
    moved = any_cube.reradiation(MAGENTA, in_nm, found.nm[~kept])
    assert np.allclose(found.throughput[~kept] * found.pdf[~kept], moved, rtol=1e-9)


def test_an_estimate_by_sampling_is_the_integral(cube, rng) -> None:
    out_nm, light = 600.0, cube.contract.illuminant.power
    drawn = cube.sample_incident(MAGENTA, out_nm, rng.random((COUNT, 2)))
    at = np.interp(drawn.nm, upglow.FINE_NM, light, left=0.0, right=0.0)
    values = drawn.throughput * at
    moved = cube.reradiation(MAGENTA, upglow.FINE_NM, out_nm)
    exact = cube.reflectance(MAGENTA, out_nm) * light[300] + integral(moved * light, upglow.FINE_NM)
    deviation = 6 * values.std() / COUNT**0.5
    assert abs(values.mean() - exact) < deviation + QUADRATURE * exact


def test_black_absorbs_everything(cube) -> None:
    black = cube.sample_incident([0.0, 0.0, 0.0], 550.0, [0.5, 0.5])
    assert black.throughput < 1e-6
    assert not cube.incident_pdf_per_nm([0.0, 0.0, 0.0], 500.0, 550.0)


def test_matrices_hold_reflectance_albedo_and_energy(any_cube, rng) -> None:
    rgb = rng.random((20, 3))
    matrix = any_cube.reradiation_matrix(rgb, upglow.FINE_NM)
    total = matrix.sum(axis=-2)
    assert total.max() <= 1 + 1e-9 and matrix.min() >= 0
    # The ends of the bands cut off a little of the emissions.
    assert np.abs(total - any_cube.albedo(rgb, upglow.FINE_NM)).max() < 2e-3
    assert np.abs(np.tril(matrix, -1)).max() > 1e-4 or any_cube.model == "reflectance"


def test_verification_holds_and_reports_progress(cube) -> None:
    told: list[tuple[str, int, int]] = []
    report = cube.verify(points=3000, progress=lambda *step: told.append(step))
    assert report.holds and report.broken == ()
    assert (report.nodes, report.points) == (729, 3000)
    energy = report.check("energy")
    assert energy.verdict == "holds" and energy.value <= energy.limit
    assert told[-1][0] == "verifying" and told[-1][1] == told[-1][2]
    assert "Every law holds" in str(report)
    assert report == cube.verify(points=3000, threads=1)
    with pytest.raises(KeyError):
        report.check("x")
