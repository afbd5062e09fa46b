"""One combination of the factors that a study varies, the seeds of one trial, and one entry of its row."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

__all__ = ["Case", "Cell", "Seeds"]

Cell = str | int | float
"""One entry of a row. Floats are written so that they read back exactly."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One combination of the factors that a study varies.

    ``options`` : further arguments of ``random_scenario``, and fields of its sensor as ``sensor.field``, in
    ``(name, value)`` pairs; all cases of a study name the same ones.
    ``graph`` : the communication graph, by its name in :data:`ratt_opt.studies.GRAPHS`.
    """

    n_robots: int
    n_targets: int
    alpha_s: int
    alpha_c: int
    objective: str = "trace"
    graph: str = "complete"
    options: tuple[tuple[str, Cell], ...] = ()

    @property
    def name(self) -> str:
        """The case in one cell: sizes, budgets, and whatever differs from the defaults."""
        parts = [f"N={self.n_robots} M={self.n_targets} alpha_s={self.alpha_s} alpha_c={self.alpha_c}"]
        parts += [value for value in (self.objective, self.graph) if value not in {"trace", "complete"}]
        parts += [f"{name}={value}" for name, value in self.options]
        return " ".join(parts)


@dataclass(frozen=True, slots=True, kw_only=True)
class Seeds:
    """Independent seeds of one trial, shared by all cases so that cases are paired."""

    scenario: int
    planner: int
    attacker: int
    simulation: int

    @classmethod
    def of(cls, root: int, trial: int) -> Seeds:
        """Return the seeds of child ``trial`` of ``SeedSequence(root).spawn``; they do not depend on the trials run."""
        # NumPy documents that the k-th child of spawn() has the spawn key (k,).
        child = np.random.SeedSequence(root, spawn_key=(trial,))
        words = (int(s.generate_state(1, np.uint64)[0] >> 1) for s in child.spawn(len(fields(cls))))
        return cls(**{field.name: word for field, word in zip(fields(cls), words, strict=True)})
