"""Lights, observers, contracts and materials as values: they compare, and travel between processes."""

from __future__ import annotations

import copy
import dataclasses
import pickle
from typing import Any

import numpy as np
import pytest

import upglow

NM = np.arange(380.0, 781.0, 10.0)
# M0 and M1 are other names of A and D50.
NAMES = [name for name in upglow.Illuminant.names() if name not in ("M0", "M1")]
LIGHTS = [upglow.Illuminant(name) for name in (*NAMES, "2856K", "D6200K")]
LAMP = upglow.Illuminant.line(500.0, 0.5)
SHORT = upglow.Illuminant((NM, 1.0 + np.cos(NM)), name="lamp", ends="zero")
BELLS = np.exp(-(((NM[::, None] - [600.0, 555.0, 450.0]) / 45.0) ** 2))
OWN = upglow.Observer((upglow.FIT_NM[16:97], np.repeat(BELLS, 2, axis=0)[:81]), name="bells")
OBSERVERS = [OWN, *(upglow.Observer(name) for name in upglow.Observer.names())]
REC709 = [0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290]
CONTRACTS = [
    upglow.Contract(),
    upglow.Contract(space=REC709, illuminant=SHORT, observer=OWN, adaptation="none"),
    *(upglow.Contract(space=space, illuminant="FL11") for space in upglow.Contract.spaces()),
]


@pytest.mark.parametrize("value", [*LIGHTS, LAMP, SHORT, *OBSERVERS, *CONTRACTS], ids=repr)
def test_lights_observers_and_contracts_travel_by_value(value: Any) -> None:
    for same in (pickle.loads(pickle.dumps(value)), copy.copy(value), copy.deepcopy(value)):
        assert type(same) is type(value) and repr(same) == repr(value)
        assert same == value and hash(same) == hash(value)


def test_the_contract_of_a_cube_is_that_it_was_built_for() -> None:
    for contract in (CONTRACTS[0], CONTRACTS[1]):
        cube = upglow.build(contract, model=upglow.Reflectance(), resolution=2)
        read = upglow.Cube.from_bytes(cube.to_bytes())
        assert contract == cube.contract == read.contract == pickle.loads(pickle.dumps(cube.contract))


def test_what_differs_is_not_equal() -> None:
    values = {*LIGHTS, LAMP, SHORT, *OBSERVERS, *CONTRACTS}
    assert len(values) == len(LIGHTS) + 2 + len(OBSERVERS) + len(CONTRACTS)
    # The same power, known on another range.
    padded = upglow.Illuminant((upglow.FINE_NM, SHORT.power), name="lamp")
    assert np.array_equal(padded.power, SHORT.power) and padded != SHORT
    assert upglow.Contract() != "acescg" and upglow.Illuminant("A") != upglow.Illuminant("D50")
    assert upglow.Contract(adaptation="none") != upglow.Contract()


def test_materials_travel(cube: upglow.Cube) -> None:
    nodes = pickle.loads(pickle.dumps(cube.nodes))
    assert nodes == cube.nodes and copy.copy(nodes) == nodes
    assert nodes != nodes[0] and nodes != "nodes"
    assert nodes != dataclasses.replace(nodes, model_id=None)
    assert np.array_equal(cube.albedo(nodes, 500.0), cube.albedo(cube.nodes, 500.0))
