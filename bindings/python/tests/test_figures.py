"""The numbers behind the figures."""

from __future__ import annotations

import json
import re
import subprocess

import numpy as np
import pytest

import upglow
from upglow import figures

ROUNDING = 1e-12


def test_the_diagram_is_that_of_the_observers_functions() -> None:
    diagram = figures.chromaticity(upglow.Contract(space="rec2020"))
    matching = upglow.Observer("cie-1931-2deg").matching
    at = np.searchsorted(upglow.FINE_NM, diagram.locus_nm)
    expected = matching[at, :2] / matching[at].sum(axis=1, keepdims=True)
    assert np.abs(diagram.locus_xy - expected).max() < ROUNDING
    assert (diagram.locus_nm[0], diagram.locus_nm[-1]) == (390, 700)
    assert np.array_equal(diagram.primaries_xy, upglow.Contract(space="rec2020").primaries_xy)
    # `cie015`, table T.3: five printed digits.
    assert np.abs(diagram.white_xy - [0.31272, 0.32903]).max() < 1.5e-5


def test_node_colors_are_the_cubes_own(cube) -> None:
    nodes = figures.node_colors(cube)
    # Single precision on the cube's side.
    assert np.abs(nodes.xyz - cube.xyz(nodes.rgb)).max() < 1e-6
    assert np.array_equal(nodes.de2000, cube.nodes.de2000)
    assert np.isnan(nodes.xy[0, 0, 0]).all()
    xy = nodes.xyz[..., :2] / nodes.xyz.sum(axis=-1, keepdims=True).clip(1e-300)
    assert np.abs(nodes.xy - xy)[1:].max() < ROUNDING
    bright = nodes.bright_xy(1.5)
    assert bright.shape == (int((nodes.xyz.sum(axis=-1) >= 1.5).sum()), 2)


def test_a_layer_of_nodes_repeats_the_errors_that_the_cube_stores(cube) -> None:
    layer = figures.layer(cube, 0.7)
    index = round(0.7 * 8)
    assert layer.blue == index / 8 and layer.rgb.shape == (9, 9, 3)
    assert np.abs(layer.de2000 - cube.nodes.de2000[index]).max() < 1e-4
    assert np.array_equal(layer.has_exact_nodes, cube.nodes.de2000[index] <= 0.01)


def test_between_exact_nodes_only_blend_has_no_error(cube) -> None:
    blend = figures.layer(cube, 0.55, side=33)
    assert blend.rgb.shape == (33, 33, 3) and blend.axis.shape == (33,)
    red, green = np.meshgrid(blend.axis, blend.axis)
    rgb = np.stack([red, green, np.full_like(red, 0.55)], axis=-1)
    assert np.abs(blend.rgb - cube.rgb_under(rgb, cube.contract.illuminant)).max() < 1e-5
    exact = blend.has_exact_nodes
    # Each of the nodes is within 0.01.
    assert exact.any() and blend.de2000[exact].max() < 0.02
    features = figures.layer(cube, 0.55, side=33, interpolation="features")
    assert np.array_equal(features.has_exact_nodes, exact)
    assert features.de2000[exact].max() > 1.0


def test_dyes_are_those_of_the_model_and_glow_inside_the_locus() -> None:
    cube = upglow.build(model=figures.KONIG_2020, resolution=2)
    dyes = figures.dyes()
    assert dyes.names == cube.dye_names == figures.dyes(cube).names
    assert np.array_equal(np.stack([dyes.absorption, dyes.emission], axis=1), cube.dye_curves)
    assert np.array_equal(dyes.nm[dyes.emission.argmax(axis=1)], dyes.emission_peak_nm)
    assert (dyes.emission_peak_nm > dyes.absorption_peak_nm).all()
    seen = dyes.emission @ upglow.Observer("cie-1931-2deg").matching
    assert np.abs(dyes.emission_xy - seen[:, :2] / seen.sum(axis=1, keepdims=True)).max() < ROUNDING
    assert figures.dyes(upglow.Dyes(set="wide14")).absorption.shape == (14, 531)
    with pytest.raises(ValueError, match="the model is reflectance, expected dyes"):
        figures.dyes(upglow.build(model=upglow.Reflectance(), resolution=2))


def test_reachability_is_what_standing_says() -> None:
    found = figures.reachability(blue=[0.2, 0.8], side=9)
    red, green = np.meshgrid(found.axis, found.axis)
    for kind, blue in zip(found.kind, found.blue):
        rgb = np.stack([red, green, np.full_like(red, blue)], axis=-1)
        assert np.array_equal(kind, upglow.standing(rgb).kind)
    assert np.abs(found.shares().sum(axis=1) - 1).max() < ROUNDING
    assert figures.reachability(side=3).kind.shape == (3, 3, 3)


def test_the_solid_of_reflectances_lies_in_that_of_fluorescence_and_holds_white() -> None:
    contract = upglow.Contract()
    passive = figures.color_solid(contract, steps=8)
    fluorescent = figures.color_solid(contract, materials="fluorescence", steps=8)
    assert passive.xyz.shape == passive.lab.shape == (9, 17, 3)
    assert np.array_equal(passive.xyz[:, 0], passive.xyz[:, -1])
    # The furthest color in a direction is at least as far with fluorescence.
    polar, azimuth = np.linspace(0, np.pi, 9)[:, None], np.linspace(0, 2 * np.pi, 17)[None]
    direction = np.stack(np.broadcast_arrays(
        np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)
    ), axis=-1)
    reach = lambda solid: (solid.xyz * direction).sum(axis=-1)  # noqa: E731
    assert (reach(fluorescent) >= reach(passive) - ROUNDING).all()
    assert (reach(fluorescent) > reach(passive) + 0.01).any()
    # White is furthest along X + Y + Z, and black in the opposite direction.
    assert np.abs(passive.xyz.max(axis=(0, 1)) - contract.white_xyz).max() < ROUNDING
    assert np.abs(passive.xyz.min(axis=(0, 1))).max() < ROUNDING
    assert abs(passive.lab[..., 0].max() - 100) < 1e-9


def test_mixed_spectra_are_means_and_mixed_features_are_not() -> None:
    ends = (450, 45, -0.009), (620, 60, -0.008)
    spectra = figures.mixed_reflectances(*ends)
    assert spectra.shape == (5, 531)
    assert np.abs(spectra[2] - (spectra[0] + spectra[4]) / 2).max() < ROUNDING
    features = figures.mixed_reflectances(*ends, mixing="features", shares=[0.5])
    assert upglow.FINE_NM[features[0].argmax()] == 535


def test_the_numbers_are_those_of_the_programs_figures(study_program, tmp_path) -> None:
    command = [study_program, "figures", "--only", "10", "--resolution", "4", "--json", "--quiet"]
    done = subprocess.run(
        [*command, "--out", str(tmp_path)], capture_output=True, text=True, check=True
    )
    told = json.dumps(json.loads(done.stdout), ensure_ascii=False)
    shares = figures.reachability(side=4).shares().mean(axis=0)
    expected = " %, ".join(f"{100 * s:.1f}" for s in shares[:2]) + f" % and {100 * shares[2]:.1f} %"
    assert re.search(re.escape(f"nodes {expected}"), told), (expected, told)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda cube: figures.layer(cube, 1.5), "blue is 1.5, expected 0 to 1"),
        (lambda cube: figures.layer(cube, float("nan")), "blue is NaN, expected 0 to 1"),
        (lambda cube: figures.layer(cube, 0.5, side=1), "side is 1, expected 2 to 2048"),
        (lambda cube: figures.layer(cube, 0.5, interpolation="x"), 'unknown interpolation "x"'),
        (lambda cube: figures.reachability(side=5000), "side is 5000, expected 2 to 2048"),
        (lambda cube: figures.reachability(blue=-1), "blue is -1, expected 0 to 1"),
        (lambda cube: figures.color_solid(steps=1), "steps is 1, expected 2 to 2048"),
        (lambda cube: figures.color_solid(materials="x"), 'unknown materials "x", expected refl'),
        (lambda cube: figures.mixed_reflectances([1], [2]), "1 features, expected shift, width"),
        (
            lambda cube: figures.mixed_reflectances((450, -1, 0.01), (450, 1, 0.01)),
            "width is -1 nm, expected > 0",
        ),
        (
            lambda cube: figures.mixed_reflectances((450, 1, 0.01), (450, 1, 0.01), mixing="x"),
            'unknown mixing "x", expected coefficients, spectra or features',
        ),
        (
            lambda cube: figures.mixed_reflectances((450, 1, 0.01), (450, 1, 0.01), shares=[2]),
            "shares is [2], expected numbers from 0 to 1",
        ),
    ],
)
def test_what_cannot_be_drawn_is_refused(cube, make, message) -> None:
    with pytest.raises(ValueError) as found:
        make(cube)
    assert str(found.value).startswith(message), found.value


def test_threads_change_nothing(cube) -> None:
    for make in (
        lambda threads: figures.node_colors(cube, threads=threads).xyz,
        lambda threads: figures.layer(cube, 0.3, side=17, threads=threads).de2000,
        lambda threads: figures.reachability(side=4, threads=threads).kind,
        lambda threads: figures.color_solid(steps=5, threads=threads).lab,
    ):
        assert np.array_equal(make(1), make(3))
