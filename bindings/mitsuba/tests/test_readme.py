"""The example of the README renders."""

from __future__ import annotations

import re
from pathlib import Path

import mitsuba as mi
import numpy as np
import pytest


@pytest.mark.usefixtures("scalar")
def test_the_scene_of_the_readme_renders(cube_file: str) -> None:
    text = (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8")
    (scene,) = re.findall(r"```xml\n(.*?)```", text, re.DOTALL)
    assert "acescg.safetensors" in scene
    made = mi.load_string(scene.replace("acescg.safetensors", cube_file))
    picture = np.array(mi.render(made, spp=1))
    assert np.isfinite(picture).all() and picture.max() > 0
