"""Measured re-radiation matrices and the materials of them."""

from pathlib import Path

import numpy as np
import pytest
from conftest import BISPECTRAL

import upglow

NM = np.arange(380.0, 781.0, 10.0)

# Sums of the same products in another order.
ROUNDING = 1e-12


def yellow() -> upglow.DonaldsonMatrix:
    values = np.diag(np.where(NM < 480.0, 0.1, 0.8))
    values[12:19, 0:9] = 0.05
    return upglow.DonaldsonMatrix(NM, NM, values, unit="per band")


def test_the_color_is_the_product_of_matrix_light_and_observer() -> None:
    matrix, light, observer = yellow(), upglow.Illuminant("D65"), upglow.Observer("cie-1931-2deg")
    at = np.isin(upglow.FINE_NM, NM)
    power, seen = light.power[at], observer.matching[at]
    expected = seen.T @ (matrix.per_band @ power) / (seen[:, 1] @ power)
    assert np.abs(matrix.color(light, observer) - expected).max() < ROUNDING
    assert np.abs(matrix.color() - expected).max() < ROUNDING


def test_a_density_is_times_the_width_of_its_band() -> None:
    matrix = upglow.DonaldsonMatrix(NM, NM, np.full((41, 41), 0.002), unit="per nm")
    assert np.abs(matrix.per_band - 0.02).max() < ROUNDING
    apart = upglow.DonaldsonMatrix(
        NM, NM, np.zeros((41, 41)), unit="per band", reflectance=(NM, np.full(41, 0.3))
    )
    assert (apart.diagonal, apart.per_band[5, 5]) == ("reflected", 0.3)


def test_a_fit_looks_like_its_matrix_and_is_a_cube(tmp_path: Path) -> None:
    fit = upglow.fit_matrix(yellow())
    for light in ("A", upglow.Illuminant("FL2")):
        found = fit.difference(light)
        assert found.de2000 < 1.0 and found.is_adapted
    cube = fit.cube()
    cube.write(tmp_path / "yellow.safetensors")
    read = upglow.Cube.read(tmp_path / "yellow.safetensors")
    shares = read.reflectance([0.2, 0.5, 0.7], NM)
    diagonal = np.diag(fit.matrix.per_band)
    # Where nothing is emitted in its own band.
    assert np.abs(shares - diagonal)[25:].max() < 1e-6


def test_faults_are_named() -> None:
    with pytest.raises(ValueError, match="41 values for 40 incident wavelengths"):
        upglow.DonaldsonMatrix(NM[:-1], NM, np.zeros((41, 41)), unit="per band")
    with pytest.raises(ValueError, match="unit of re-radiation"):
        upglow.DonaldsonMatrix(NM, NM, np.zeros((41, 41)), unit="percent")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="measured with two emitting dyes"):
        upglow.fit_matrix(yellow(), count=2, reflectance="measured")


@pytest.mark.skipif(not BISPECTRAL.is_dir(), reason="no ../shared/data/bispectral")
def test_the_measured_materials_are_read_and_fitted() -> None:
    matrix = upglow.DonaldsonMatrix.from_bfc(BISPECTRAL / "TEXTYELL.BFC")
    assert matrix.per_band.shape == (41, 49)
    assert matrix.noise is not None and matrix.noise[0] < 0.001
    assert upglow.fit_matrix(matrix).difference("A").de2000 < 1.0
