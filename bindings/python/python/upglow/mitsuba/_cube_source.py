"""The parameter `cube`: the path of a cube's file, or the name of a cube in memory."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from .._cube import Cube
from ._host import is_scalar, mi
from ._jit_cube import JitCube
from ._scalar_cube import ScalarCube

_IN_MEMORY = "upglow cube "
"""Prefix of the names of cubes in memory."""

_REMEMBERED_FILES = 8
"""Files whose cubes are kept for further scenes."""

DeviceCube = JitCube | ScalarCube

_in_memory: dict[str, Cube] = {}
_from_files: dict[tuple[str, int, int], Cube] = {}
_on_device: dict[tuple[str, int], tuple[Cube, DeviceCube]] = {}


def in_memory(cube: Cube) -> str:
    """A name for a cube in memory, for the parameter `cube` of a scene.

    Parameters of Mitsuba's plugins are numbers, strings or its own objects. The cube is kept until
    the program ends. The same cube always gets the same name.

    Examples
    --------
    >>> import upglow, upglow.mitsuba
    >>> cube = upglow.build(resolution=2)
    >>> {"type": "upglow", "cube": upglow.mitsuba.in_memory(cube), "color": [0.9, 0.5, 0.4]}
    {'type': 'upglow', 'cube': 'upglow cube 0', 'color': [0.9, 0.5, 0.4]}
    """
    for name, known in _in_memory.items():
        if known is cube:
            return name
    name = f"{_IN_MEMORY}{len(_in_memory)}"
    _in_memory[name] = cube
    return name


def cube_named(source: Any) -> Cube:
    """The cube that the parameter names."""
    if not isinstance(source, str):
        raise ValueError(f"cube is of type {type(source).__name__}, expected a path")
    if source in _in_memory:
        return _in_memory[source]
    # A relative path is searched for where the scene's other files are.
    path = Path(str(mi.file_resolver().resolve(source)))
    try:
        state = os.stat(path)
        key = (str(path), state.st_mtime_ns, state.st_size)
        if key not in _from_files:
            while len(_from_files) >= _REMEMBERED_FILES:
                del _from_files[next(iter(_from_files))]
            _from_files[key] = Cube.read(path)
        return _from_files[key]
    except OSError as error:
        raise ValueError(f"cube {source}: {error.strerror or error}") from None
    except ValueError as error:
        raise ValueError(f"cube {error}") from None


def on_device(cube: Cube) -> DeviceCube:
    """The cube's arrays on the device of the current variant; made once."""
    key = (str(mi.variant()), id(cube))
    if key not in _on_device:
        while len(_on_device) >= _REMEMBERED_FILES:
            del _on_device[next(iter(_on_device))]
        _on_device[key] = cube, ScalarCube(cube) if is_scalar() else JitCube(cube)
    return _on_device[key][1]
