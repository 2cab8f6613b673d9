"""Physically valid spectral materials, with fluorescence, for any RGB color.

A *contract* says what RGB means. A *cube* holds a material for each node of a grid over RGB, and
answers for arrays of colors: reflectance, re-radiation, color under any light, sampling.

    >>> import upglow
    >>> cube = upglow.build(upglow.Contract(space="acescg"), resolution=9)
    >>> cube.reflectance([0.9, 0.1, 0.8], [450.0, 550.0, 650.0]).round(2).tolist()
    [0.89, 0.06, 0.93]
    >>> cube.reradiation([0.9, 0.1, 0.8], 550.0, [560.0, 600.0, 640.0]).shape
    (3,)

Conventions, everywhere:

- RGB is linear, in the contract's space, of shape ``(..., 3)``. Results keep the leading shape.
- Wavelengths are nm. Densities over wavelength are per nm.
- XYZ is relative: Y = 1 is the perfect diffuser under the contract's illuminant.
- Results for float32 RGB are single precision where the library supports it; for all other types,
  double precision.
- Each color is computed independently: no result depends on the number of threads or on how an
  array is split.
- ``threads=None`` uses one thread per core. Python's global lock is released during the work.
- Invalid input raises a ``ValueError``, and an argument of another kind a ``TypeError``, that says what was
  found and what was expected.

The library's own documentation, the file format and the physics: see the repository's ``README.md``,
``docs/cube-format.md`` and ``docs/decisions``.
"""

from . import figures
from ._contract import Contract
from ._cube import Cube, CubeCheck, CubeSummary, Relit, Samples, build
from ._illuminant import Illuminant
from ._materials import Corners, Materials
from ._matrix import DonaldsonMatrix, MatrixDifference, MatrixFit, fit_matrix
from ._metamers import MetamerColors, Metamers, OwnMaterial, metamers
from ._models import Analytic, Dye, Dyes, Film, Reflectance
from ._observer import Observer
from ._standing import Kind, Standing, standing
from ._upglow import __version__
from ._verify import Check, VerifyReport
from ._wavelengths import FINE_NM, FIT_NM

__all__ = [
    "FINE_NM",
    "FIT_NM",
    "Analytic",
    "Check",
    "Contract",
    "Corners",
    "Cube",
    "CubeCheck",
    "CubeSummary",
    "DonaldsonMatrix",
    "Dye",
    "Dyes",
    "Film",
    "Illuminant",
    "Kind",
    "Materials",
    "MatrixDifference",
    "MatrixFit",
    "MetamerColors",
    "Metamers",
    "Observer",
    "OwnMaterial",
    "Reflectance",
    "Relit",
    "Samples",
    "Standing",
    "VerifyReport",
    "__version__",
    "build",
    "figures",
    "fit_matrix",
    "metamers",
    "standing",
]
