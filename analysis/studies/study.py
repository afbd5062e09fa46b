"""What a study is: the cases it compares, and what it measures in every trial."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass, fields
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["Case", "Cell", "Seeds", "Study", "run_trial"]

Cell = str | int | float
"""One entry of a row. Floats are written so that they read back exactly."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One combination of the factors that a study varies.

    ``options`` : further arguments of ``random_scenario``, and fields of its sensor as ``sensor.field``, in
    ``(name, value)`` pairs; all cases of a study name the same ones.
    ``graph`` : the communication graph, by its name in :mod:`analysis.studies.instance`.
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


@dataclass(frozen=True, slots=True, kw_only=True)
class Study:
    """A study as data; :func:`analysis.studies.engine.run` runs it.

    Parameters
    ----------
    name : folder of its results
    version : raised when the meaning of a row changes; older results are then refused
    cases : combinations of factors; every trial visits each of them
    planners, attackers : names in :mod:`analysis.studies.comparison`
    metrics : what is measured for every planner and attacker
    quantities : what is measured once for every case and trial
    measure : ``module:function`` that measures one trial; by default the comparison of planners under attackers
    seed : root of all seeds
    fixed_trials : number of trials where nothing is random; otherwise the command line decides
    """

    name: str
    version: int = 1
    cases: tuple[Case, ...]
    planners: tuple[str, ...] = ()
    attackers: tuple[str, ...] = ()
    metrics: tuple[str, ...] = ()
    quantities: tuple[str, ...] = ()
    measure: str = "analysis.studies.comparison:measure"
    seed: int = 2022
    fixed_trials: int | None = None

    def definition(self) -> dict[str, Any]:
        """Return everything that decides the rows, as JSON types."""
        document: dict[str, Any] = json.loads(json.dumps(asdict(self)))
        return document

    def fingerprint(self) -> str:
        """Return a hash of the definition; equal exactly for equal definitions."""
        return hashlib.sha256(json.dumps(self.definition(), sort_keys=True).encode()).hexdigest()[:16]


def run_trial(study: Study, case: int, trial: int) -> dict[str, Cell]:
    """Measure one trial of one case: the unit of work, a pure function of its arguments."""
    from analysis.studies.versions import VERSIONS

    chosen, seeds = study.cases[case], Seeds.of(study.seed, trial)
    measure: Callable[[Study, Case, Seeds], dict[str, Cell]] = resolve_name(study.measure)
    factors: dict[str, Cell] = {
        "n_robots": chosen.n_robots,
        "n_targets": chosen.n_targets,
        "alpha_s": chosen.alpha_s,
        "alpha_c": chosen.alpha_c,
        "objective": chosen.objective,
        "graph": chosen.graph,
    }
    head: dict[str, Cell] = {"case": chosen.name, "trial": trial, "seed": seeds.scenario, "versions": VERSIONS}
    return {**head, **factors, **dict(chosen.options), **measure(study, chosen, seeds)}
