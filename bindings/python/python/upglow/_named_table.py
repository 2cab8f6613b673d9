"""Lights and observers: tables with a name and a value for each nm."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from ._kinds import instance
from ._spectra import samples


class NamedTable:
    """What lights and observers have in common."""

    __slots__ = ("_native",)

    _native: Any
    _kind: ClassVar[Any]
    """Class of the native half."""
    _values: ClassVar[str]
    """Name of the native half's array."""
    _columns: ClassVar[int | None] = None
    """Values per wavelength, where there is more than one."""

    def __init__(self, source: Any, *, name: str | None = None) -> None:
        self._native = self._native_of(source, name)

    @classmethod
    def _native_of(cls, source: Any, name: str | None, *rules: str) -> Any:
        """The native half; the native class takes `rules` of reading after the samples."""
        if name is not None:
            instance("name", name, str, "a text")
        for native in (source, getattr(source, "_native", None)):
            if isinstance(native, cls._kind):
                return cls._without(name, rules, native)
        if isinstance(source, (str, os.PathLike)):
            return cls._named_or_read(os.fspath(source), name, rules)
        kind = cls.__name__
        otherwise = f"a name, a path, an {kind}, "
        nm, values = samples(kind.lower(), source, columns=cls._columns, otherwise=otherwise)
        label = name or str(getattr(source, "name", "custom"))
        arrays = np.ascontiguousarray(nm), np.ascontiguousarray(values)
        try:
            return cls._kind.from_samples(label, *arrays, *rules)
        except ValueError:
            # The source may be called like a built-in table with other numbers, such as one extended
            # to our range. Any other fault is found again.
            if not name:
                with suppress(ValueError):
                    return cls._kind.from_samples(f"{label} (samples)", *arrays, *rules)
            raise

    @classmethod
    def _named_or_read(cls, word: str, name: str | None, rules: tuple[str, ...]) -> Any:
        """A built-in table, or one from a file, called `name` or after the file."""
        try:
            native = cls._kind.named(word)
        except ValueError:
            if not is_path(word):
                raise
        else:
            return cls._without(name, rules, native)
        path = Path(word)
        text = path.read_text(encoding="utf-8")
        try:
            if name:
                return cls._kind.from_csv(name, text, *rules)
            return cls._kind.from_csv_file(path, text, *rules)
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from None

    @classmethod
    def _without(cls, name: str | None, rules: tuple[str, ...], native: Any) -> Any:
        """A table that has its name and is not made of samples: rules of reading would have no effect."""
        given = {"ends": rules[0] if rules else None, "name": None if name == native.name else name}
        for option, value in given.items():
            if value is not None:
                raise ValueError(
                    f"{option}={value!r} with {native.name}, expected samples or a file"
                )
        return native

    @classmethod
    def names(cls) -> list[str]:
        """The built-in names."""
        names: list[str] = cls._kind.names()
        return names

    @property
    def name(self) -> str:
        """The name that files state."""
        name: str = self._native.name
        return name

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.name!r})"

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())

    def _key(self) -> tuple[Any, ...]:
        return self.name, getattr(self._native, self._values).tobytes()


def is_path(word: str) -> bool:
    """Whether a word that is not a built-in name means a file or folder; ``FL3.16`` does not."""
    path = Path(word)
    return path.exists() or len(path.parts) > 1 or path.suffix[1:2].isalpha()
