"""Lights for the renderer."""

from __future__ import annotations

import host
import numpy as np
import pytest

import upglow

mi = pytest.importorskip("mitsuba", reason="needs the package mitsuba")

# Nine printed digits, and single precision in the renderer.
PRINTED_TOL = 1e-6


@pytest.fixture(autouse=True, params=[host.SCALAR, host.LLVM])
def variant(request) -> None:
    host.renderer(request.param)


@pytest.mark.parametrize("name", ["D65", "A", "E"])
def test_white_light_has_a_luminance_of_its_scale(name) -> None:
    spectrum = upglow.mitsuba.spectrum(name, 2.5)
    assert abs(host.xyz_of(host.light_of(spectrum))[1] - 2.5) < PRINTED_TOL


def test_a_lamp_by_power_has_that_of_its_reference() -> None:
    lamp = host.light_of(upglow.mitsuba.spectrum(upglow.Illuminant.line(365, 12), 3, by="power"))
    for reference in ("D65", "A"):
        lamp = upglow.mitsuba.spectrum((upglow.FINE_NM, lamp), 3, by="power", reference=reference)
        lamp = host.light_of(lamp)
        assert abs(lamp.sum() / host.light_of(upglow.mitsuba.spectrum(reference)).sum() - 3) < 1e-6


def test_the_renderer_sees_the_light_from_300_to_830_nm() -> None:
    power = upglow.Illuminant("D65").power
    texture = mi.load_dict(upglow.mitsuba.spectrum("D65"))
    si = mi.SurfaceInteraction3f()
    si.wavelengths = mi.Spectrum(300, 340.5, 560, 829)
    found = np.array(texture.eval(si), dtype=np.float64).ravel()
    expected = np.interp([300, 340.5, 560, 829], upglow.FINE_NM, power)
    assert np.allclose(found / found[2], expected / expected[2], rtol=PRINTED_TOL)


def test_what_is_no_light_is_refused() -> None:
    dark = np.where(upglow.FINE_NM < 350, 1.0, 0.0)
    with pytest.raises(ValueError, match="no power between 360 and 830 nm, expected some"):
        upglow.mitsuba.spectrum((upglow.FINE_NM, dark), by="power")
    with pytest.raises(ValueError, match="by is 'x', expected white or power"):
        upglow.mitsuba.spectrum("D65", by="x")
    with pytest.raises(ValueError, match="D66"):
        upglow.mitsuba.spectrum("D66")
