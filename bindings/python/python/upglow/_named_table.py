"""Tables that have a name and a value for each nm: lights and observers."""

from __future__ import annotations

import os
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from . import _upglow
from ._names_and_files import named_or_read
from ._wavelengths import samples

Native = TypeVar("Native", _upglow.Illuminant, _upglow.Observer)


class NamedTable:
    """What is the same where its name and its table are."""

    __slots__ = ()

    @property
    def name(self) -> str:
        """The name that files state."""
        raise NotImplementedError

    @property
    def _table(self) -> NDArray[np.float64]:
        raise NotImplementedError

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.name!r})"

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())

    def _key(self) -> tuple[str, bytes]:
        return self.name, self._table.tobytes()


def native_table(
    kind: type[Native], source: Any, name: str | None, *, columns: int | None = None
) -> Native:
    """The native half of a table, from what the classes of tables are made from."""
    for native in (source, getattr(source, "_native", None)):
        if isinstance(native, kind):
            return native
    if isinstance(source, (str, os.PathLike)):
        return named_or_read(os.fspath(source), name, kind.named, kind.from_csv)
    nm, values = samples(kind.__name__.lower(), source, columns=columns)
    label = name or str(getattr(source, "name", "custom"))
    return kind.from_samples(label, np.ascontiguousarray(nm), np.ascontiguousarray(values))
