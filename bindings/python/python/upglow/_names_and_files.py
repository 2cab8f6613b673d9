"""Words that are built-in names or paths of CSV files."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

Named = TypeVar("Named")


def named_or_read(
    word: str,
    name: str | None,
    named: Callable[[str], Named],
    from_csv: Callable[[str, str], Named],
) -> Named:
    """What a word means: a built-in name first, else a file, which is called `name` or like itself."""
    path = Path(word)
    try:
        return named(word)
    except ValueError:
        if not is_path(path):
            raise
    text = path.read_text(encoding="utf-8")
    try:
        return from_csv(name or path.stem, text)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def is_path(path: Path) -> bool:
    """Whether a word that is no built-in name is meant as a file or folder."""
    return path.exists() or len(path.parts) > 1 or bool(path.suffix)
