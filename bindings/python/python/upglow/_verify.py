"""Results of the verification of a cube."""

from __future__ import annotations

from dataclasses import dataclass

from ._html import table


@dataclass(frozen=True)
class Check:
    """One law of a cube that was checked, or one figure that was measured."""

    name: str
    """A short name that does not change."""
    about: str
    """What ``value`` is."""
    verdict: str
    """``holds``, ``broken``, ``reported`` (a figure without a limit) or ``not applicable``."""
    value: float
    """The worst value found, or the figure reported."""
    limit: float | None
    """What ``value`` must not exceed; ``None`` for figures."""
    unit: str
    """Unit of ``value`` and ``limit``; empty for plain numbers."""
    checked: int
    """How many nodes, colors or curves were checked."""
    violations: int
    """How many of them break the law."""
    worst: str | None
    """Where the worst value was found, in words."""


@dataclass(frozen=True, kw_only=True, repr=False)
class VerifyReport:
    """Every law and every figure of a cube, recomputed at every nm from its stored numbers."""

    nodes: int
    """Nodes checked."""
    points: int
    """Random colors between the nodes checked."""
    holds: bool
    """Whether no law is broken."""
    checks: tuple[Check, ...]
    """Every law and every figure, in a fixed order."""

    def check(self, name: str) -> Check:
        """The check of this name; ``KeyError`` for an unknown name."""
        for check in self.checks:
            if check.name == name:
                return check
        raise KeyError(name)

    @property
    def broken(self) -> tuple[Check, ...]:
        """The laws that are broken."""
        return tuple(check for check in self.checks if check.verdict == "broken")

    def __str__(self) -> str:
        lines = [f"{c.name:24}{c.verdict:16}{c.value:<12.4g}{c.unit}" for c in self.checks]
        return "\n".join([*lines, f"{self._verdict()}."])

    def __repr__(self) -> str:
        return f"VerifyReport({self._verdict()})"

    def _repr_html_(self) -> str:
        rows = {c.name: f"{c.verdict}, {c.value:.4g} {c.unit}" for c in self.checks}
        return table(self._verdict(), rows)

    def _verdict(self) -> str:
        verdict = "Every law holds" if self.holds else f"{len(self.broken)} laws are broken"
        return f"{verdict} for {self.nodes} nodes, {self.points} colors"
