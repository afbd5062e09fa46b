"""What a study is: the cases it compares, and what it measures in every trial."""

from __future__ import annotations

import hashlib
import json
import sys
from dataclasses import asdict, dataclass, fields
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from ratt_opt.problem import Problem

__all__ = ["Case", "Cell", "Seeds", "Study", "name_of", "path_of", "run_trial"]

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
    planners, attackers : names in :mod:`analysis.studies.instance`, or functions like those there, which columns of
        the table call by their own names
    metrics : what is measured for every planner and attacker
    quantities : what is measured once for every case and trial
    problem : function ``(case, seeds) -> Problem`` that makes the problem of a trial; by default that of a random
        scenario. Metrics of physical scenarios (``trace``, ``mse``) need the default
    measure : function ``(study, case, seeds) -> row`` that measures one trial, or its ``module:function``; by default
        the comparison of planners under attackers
    seed : root of all seeds
    fixed_trials : number of trials where nothing is random; otherwise the command line decides

    Functions stand at the top of their module, so that worker processes find them.

    Raises
    ------
    InputError : a function is a lambda or stands inside another, or two planners or attackers have one name.
    """

    name: str
    version: int = 1
    cases: tuple[Case, ...]
    planners: tuple[str | Callable[..., Any], ...] = ()
    attackers: tuple[str | Callable[..., Any], ...] = ()
    metrics: tuple[str, ...] = ()
    quantities: tuple[str, ...] = ()
    problem: Callable[[Case, Seeds], Problem] | None = None
    measure: str | Callable[[Study, Case, Seeds], dict[str, Cell]] = "analysis.studies.comparison:measure"
    seed: int = 2022
    fixed_trials: int | None = None

    def __post_init__(self) -> None:
        for kind in ("planners", "attackers"):
            names = list(map(name_of, getattr(self, kind)))
            if len(set(names)) < len(names):
                raise InputError(kind, "must have different names", ", ".join(names))
        for function in self._own():
            path_of(function)

    @property
    def planner_names(self) -> tuple[str, ...]:
        """What columns call the planners."""
        return tuple(map(name_of, self.planners))

    @property
    def attacker_names(self) -> tuple[str, ...]:
        """What columns call the attackers."""
        return tuple(map(name_of, self.attackers))

    def _own(self) -> Iterator[Callable[..., Any]]:
        """The functions that are given as such."""
        every = (self.measure, self.problem, *self.planners, *self.attackers)
        yield from (member for member in every if callable(member))

    def modules(self) -> tuple[str, ...]:
        """Return the names of the modules, besides the engine's own, whose code decides the rows."""
        paths = [self.measure if isinstance(self.measure, str) else path_of(self.measure), *map(path_of, self._own())]
        return tuple(sorted({path.partition(":")[0] for path in paths}))

    def definition(self) -> dict[str, Any]:
        """Return everything that decides the rows, as JSON types; functions as ``module:function``."""
        plain = {name: value for name, value in asdict(self).items() if name != "problem" or value is not None}
        document: dict[str, Any] = json.loads(json.dumps(plain, default=path_of))
        return document

    def fingerprint(self) -> str:
        """Return a hash of the definition; equal exactly for equal definitions."""
        return hashlib.sha256(json.dumps(self.definition(), sort_keys=True).encode()).hexdigest()[:16]


def name_of(member: str | Callable[..., Any]) -> str:
    """Return what columns call a planner or attacker."""
    return member if isinstance(member, str) else str(getattr(member, "__name__", member))


def path_of(function: Callable[..., Any]) -> str:
    """Return the ``module:function`` by which other processes find a function; also of the module that was run.

    Raises
    ------
    InputError : it has none.
    """
    module, name = getattr(function, "__module__", None), getattr(function, "__qualname__", "<")
    if module is None or "<" in name:
        raise InputError("study", "must be given functions that stand at the top of a module", repr(function))
    run = sys.modules["__main__"].__spec__ if module == "__main__" else None
    return f"{module if run is None else run.name}:{name}"


def run_trial(study: Study, case: int, trial: int) -> dict[str, Cell]:
    """Measure one trial of one case: the unit of work, a pure function of its arguments."""
    from analysis.studies.versions import VERSIONS

    chosen, seeds = study.cases[case], Seeds.of(study.seed, trial)
    given = study.measure
    measure: Callable[[Study, Case, Seeds], dict[str, Cell]] = resolve_name(given) if isinstance(given, str) else given
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
