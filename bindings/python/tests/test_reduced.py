"""Materials as 4×4 matrices, for engines without spectra."""

import numpy as np
import pytest

import upglow


@pytest.fixture
def rgb() -> np.ndarray:
    return np.random.default_rng(4).random((3, 5, 3))


def test_under_the_contracts_light_the_color_is_the_materials(any_cube, rgb) -> None:
    light = any_cube.reduced_light()
    found = any_cube.reduced_matrix(rgb) @ light
    # `xyz` is in single precision.
    np.testing.assert_allclose(found[..., :3], any_cube.xyz(rgb), atol=2e-6)
    three = any_cube.without_ultraviolet(any_cube.reduced_matrix(rgb)) @ light[:3]
    np.testing.assert_allclose(three, found[..., :3], atol=1e-12)


def test_matrices_keep_the_leading_shape_and_the_precision(any_cube, rgb) -> None:
    double, single = any_cube.reduced_matrix(rgb), any_cube.reduced_matrix(rgb.astype(np.float32))
    assert double.shape == single.shape == (3, 5, 4, 4)
    assert double.dtype == np.float64 and single.dtype == np.float32
    # Single precision of RGB and of matrices of a few units.
    np.testing.assert_allclose(single, double, atol=2e-5)
    assert np.isnan(any_cube.reduced_matrix([0.5, 1.5, 0.5], outside="nan")).all()
    with pytest.raises(ValueError, match="green is 1.5"):
        any_cube.reduced_matrix([0.5, 1.5, 0.5])


def test_stored_materials_have_the_matrices_of_their_colors(any_cube) -> None:
    corner = any_cube.nodes[-1, -1, -1]
    # Single precision of what a cube stores.
    np.testing.assert_allclose(
        any_cube.reduced_matrix(corner), any_cube.reduced_matrix([1.0, 1.0, 1.0]), atol=1e-5
    )


def test_lights_have_daylights_ultraviolet_as_their_unit(any_cube) -> None:
    np.testing.assert_allclose(any_cube.reduced_light("D65"), any_cube.reduced_light())
    assert any_cube.reduced_light("D65")[3] == pytest.approx(1.0)
    assert any_cube.reduced_light("A")[3] < 0.2
    assert any_cube.reduced_light("D65-cut400")[3] < any_cube.reduced_light("D65")[3]


@pytest.mark.parametrize("engine", ["rec709", "acescg", [0.7, 0.3, 0.2, 0.7, 0.1, 0.1, 0.33, 0.33]])
def test_an_engine_has_light_of_its_own_primaries(any_cube, rgb, engine) -> None:
    own = any_cube.contract
    contract = upglow.Contract(
        space=engine,
        illuminant=own.illuminant,
        observer=own.observer,
        adaptation=own.adaptation,
    )
    np.testing.assert_allclose(any_cube.reduced_light(engine=engine), 1.0, atol=1e-9)
    for light in [None, "A"]:
        seen = any_cube.reduced_matrix(rgb) @ any_cube.reduced_light(light)
        found = any_cube.reduced_matrix(rgb, engine=engine) @ any_cube.reduced_light(
            light, engine=engine
        )
        # Rounding only, of numbers up to 10 and of an inverse.
        expected = seen[..., :3] @ contract.rgb_from_xyz.T
        np.testing.assert_allclose(found[..., :3], expected, atol=1e-12)
        np.testing.assert_allclose(found[..., 3], seen[..., 3], atol=1e-12)
    with pytest.raises(ValueError, match="unknown RGB space"):
        any_cube.reduced_light(engine="rgb")


def test_what_is_no_matrix_is_refused(any_cube) -> None:
    with pytest.raises(ValueError, match=r"matrices has shape \(3, 3\), expected \(..., 4, 4\)"):
        any_cube.without_ultraviolet(np.eye(3))
