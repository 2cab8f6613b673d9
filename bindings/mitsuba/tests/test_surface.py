"""The BSDF `upglow`: what it says at each wavelength is what the library says."""

from __future__ import annotations

from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np
import pytest
import upglow
from numpy.typing import NDArray

SINGLE = 1e-5
"""Between look-ups in single and in double precision, by the promise of the run-time library."""

TABLE = 2e-4
"""Straight lines between reflectances by 1 nm, where a dye's curve is steep and the reflectance
that it multiplies too; and 16 bits a sample. Measured: 1.7e-4."""

ANYWHERE_NM = (300.0, 830.0)
COLOR = (0.05, 0.9, 0.1)


def surface(cube_file: str, color: Any) -> dict[str, Any]:
    return {"type": "upglow", "cube": cube_file, "color": color}


def texture(picture: NDArray[np.float32], **other: Any) -> dict[str, Any]:
    """A picture of linear colors, each texel by itself."""
    return {
        "type": "bitmap",
        "raw": True,
        "filter_type": "nearest",
        "bitmap": mi.Bitmap(picture),
        **other,
    }


def point(nm: NDArray[Any], uv: Any = (0.5, 0.5), wi: Any = (0, 0, 1)) -> Any:
    """A point of a surface that is seen at some wavelengths; `nm` is of shape (4,)."""
    si = dr.zeros(mi.SurfaceInteraction3f)
    si.wi, si.uv, si.wavelengths = wi, uv, nm
    return si


def points(nm: NDArray[Any], uv: NDArray[Any]) -> Any:
    """Many points; `nm` is of shape (4, n), `uv` of shape (2, n)."""
    si = dr.zeros(mi.SurfaceInteraction3f, nm.shape[1])
    si.wi, si.uv = mi.Vector3f(0, 0, 1), mi.Point2f(uv.astype(np.float32))
    si.wavelengths = mi.Spectrum(nm.astype(np.float32))
    return si


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(20260101)


@pytest.mark.usefixtures("scalar")
def test_reflectance_is_the_librarys_for_any_color_and_wavelength(
    cube: upglow.Cube, cube_file: str, rng: np.random.Generator
) -> None:
    for color in rng.uniform(size=(50, 3)):
        bsdf = mi.load_dict(surface(cube_file, color.tolist()))
        nm = rng.uniform(*ANYWHERE_NM, size=4)
        found = np.array(bsdf.eval(mi.BSDFContext(), point(nm), [0, 0, 1])) * np.pi
        np.testing.assert_allclose(found, cube.reflectance(color, nm), atol=SINGLE)


@pytest.mark.usefixtures("scalar")
def test_value_density_and_samples_agree(cube_file: str, rng: np.random.Generator) -> None:
    bsdf, context = mi.load_dict(surface(cube_file, COLOR)), mi.BSDFContext()
    si = point(np.array([450.0, 520, 590, 660]), wi=(0.6, 0, 0.8))
    whole = np.array(bsdf.eval_diffuse_reflectance(si))
    for u in rng.uniform(size=(20, 2)):
        drawn, weight = bsdf.sample(context, si, 0.5, u)
        value, density = bsdf.eval_pdf(context, si, drawn.wo)
        assert density == pytest.approx(drawn.pdf, rel=1e-6)
        assert density == pytest.approx(drawn.wo[2] / np.pi, rel=1e-6)
        np.testing.assert_allclose(value, np.array(weight) * density, rtol=1e-6)
        np.testing.assert_allclose(weight, whole, rtol=1e-6)


@pytest.mark.usefixtures("scalar")
def test_the_back_is_black(cube_file: str) -> None:
    bsdf, context = mi.load_dict(surface(cube_file, COLOR)), mi.BSDFContext()
    nm = np.array([450.0, 520, 590, 660])
    assert dr.all(bsdf.eval(context, point(nm), [0, 0, -1]) == 0)
    assert dr.all(bsdf.eval(context, point(nm, wi=(0, 0, -1)), [0, 0, 1]) == 0)
    drawn, weight = bsdf.sample(context, point(nm, wi=(0, 0, -1)), 0.5, [0.3, 0.3])
    assert drawn.pdf == 0 and dr.all(weight == 0)


@pytest.mark.usefixtures("scalar")
def test_a_texel_has_the_material_of_its_color(
    cube: upglow.Cube, cube_file: str, rng: np.random.Generator
) -> None:
    picture = rng.uniform(size=(8, 8, 3)).astype(np.float32)
    bsdf = mi.load_dict(surface(cube_file, texture(picture)))
    for row, column in np.ndindex(8, 8):
        nm = rng.uniform(*ANYWHERE_NM, size=4)
        si = point(nm, uv=((column + 0.5) / 8, (row + 0.5) / 8))
        expected = cube.reflectance(picture[row, column].astype(float), nm)
        np.testing.assert_allclose(bsdf.eval_diffuse_reflectance(si), expected, atol=SINGLE)


@pytest.mark.usefixtures("scalar")
def test_texels_outside_the_cube_are_the_nearest_color_of_it(
    cube: upglow.Cube, cube_file: str
) -> None:
    nm = np.array([450.0, 520, 590, 660])
    for texel, nearest in [((-0.5, 2, 0.5), (0, 1, 0.5)), ((np.nan, 0.5, 0.5), (0, 0.5, 0.5))]:
        picture = np.full((1, 1, 3), texel, dtype=np.float32)
        bsdf = mi.load_dict(surface(cube_file, texture(picture)))
        found = bsdf.eval_diffuse_reflectance(point(nm))
        np.testing.assert_allclose(found, cube.reflectance(nearest, nm), atol=SINGLE)


@pytest.mark.usefixtures("scalar")
def test_a_color_can_be_changed(cube: upglow.Cube, cube_file: str) -> None:
    bsdf, nm = mi.load_dict(surface(cube_file, COLOR)), np.array([450.0, 520, 590, 660])
    parameters = mi.traverse(bsdf)
    parameters["color"] = [0.5, 0.25, 0.125]
    parameters.update()
    found = bsdf.eval_diffuse_reflectance(point(nm))
    np.testing.assert_allclose(found, cube.reflectance((0.5, 0.25, 0.125), nm), atol=SINGLE)


@pytest.mark.usefixtures("scalar")
def test_a_scene_file_names_the_color_as_a_vector(cube: upglow.Cube, cube_file: str) -> None:
    bsdf = mi.load_string(
        f'<bsdf version="3.0.0" type="upglow"><string name="cube" value="{cube_file}"/>'
        '<vector name="color" value="0.05, 0.9, 0.1"/></bsdf>'
    )
    assert "color = [0.05, 0.9, 0.1]" in str(bsdf)
    nm = np.array([450.0, 520, 590, 660])
    found = bsdf.eval_diffuse_reflectance(point(nm))
    np.testing.assert_allclose(found, cube.reflectance(COLOR, nm), atol=SINGLE)


@pytest.mark.usefixtures("traced")
def test_traced_code_reads_the_same_reflectance(
    cube: upglow.Cube, cube_file: str, rng: np.random.Generator
) -> None:
    for color in rng.uniform(size=(8, 3)):
        bsdf = mi.load_dict(surface(cube_file, color.tolist()))
        nm = rng.uniform(*ANYWHERE_NM, size=(4, 512))
        si = points(nm, np.full((2, 512), 0.5))
        found = np.array(bsdf.eval(mi.BSDFContext(), si, mi.Vector3f(0, 0, 1))) * np.pi
        expected = cube.reflectance(color, nm.ravel()).reshape(nm.shape)
        np.testing.assert_allclose(found, expected, atol=TABLE)


@pytest.mark.usefixtures("traced")
def test_traced_textures_are_blends_of_the_same_four_nodes(
    cube: upglow.Cube, cube_file: str, rng: np.random.Generator
) -> None:
    nodes = (cube.resolution - 1) * rng.uniform(size=(32, 32, 3))
    nodes[:8] = np.round(nodes[:8])  # On nodes, edges and diagonals of cells, where fractions tie.
    nodes[8:16, :, 1] = nodes[8:16, :, 0]
    picture = (nodes / (cube.resolution - 1)).astype(np.float32)
    bsdf = mi.load_dict(surface(cube_file, texture(picture)))
    row, column = np.indices((32, 32)).reshape(2, -1)
    nm = rng.uniform(*ANYWHERE_NM, size=(4, row.size))
    si = points(nm, (np.array([column, row]) + 0.5) / 32)
    found = np.array(bsdf.eval_diffuse_reflectance(si))
    for i in range(row.size):
        expected = cube.reflectance(picture[row[i], column[i]].astype(float), nm[:, i])
        np.testing.assert_allclose(found[:, i], expected, atol=TABLE)


@pytest.mark.usefixtures("traced")
def test_traced_functions_can_be_frozen_and_replayed(
    cube: upglow.Cube, cube_file: str, rng: np.random.Generator
) -> None:
    @dr.freeze
    def seen(bsdf: Any, si: Any) -> Any:
        return bsdf.eval_diffuse_reflectance(si)

    for color in [list(COLOR), texture(np.full((2, 2, 3), COLOR, dtype=np.float32))]:
        bsdf = mi.load_dict(surface(cube_file, color))
        for _ in range(3):
            nm = rng.uniform(*ANYWHERE_NM, size=(4, 64))
            found = np.array(seen(bsdf, points(nm, np.full((2, 64), 0.5))))
            expected = cube.reflectance(COLOR, nm.ravel()).reshape(nm.shape)
            np.testing.assert_allclose(found, expected, atol=TABLE)


@pytest.mark.usefixtures("traced")
def test_traced_pictures_have_the_color_of_scalar_ones(cube_file: str) -> None:
    from plane import mean_and_error, normalized, pixels, scene, sky

    pictures = {}
    for variant in ["scalar_spectral", "llvm_ad_spectral"]:
        mi.set_variant(variant)
        light = sky(normalized(upglow.Illuminant("D65")))
        made = scene(surface(cube_file, COLOR), light, {"type": "path"})
        pictures[variant] = mean_and_error(pixels(made))
    (one, error), (other, other_error) = pictures.values()
    # Four standard errors of the difference, and the table's.
    assert (abs(one - other) <= 4 * np.hypot(error, other_error) + TABLE).all(), pictures
