"""Studies: the cases they compare, and what they measure in every trial."""

from __future__ import annotations

import hashlib
import json
import sys
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields, is_dataclass
from functools import partial
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any, TypeVar

from ratt_opt.errors import InputError
from ratt_opt.missions.players.named import name_of
from ratt_opt.studies.cases import Cell, Seeds
from ratt_opt.studies.instance import ATTACKERS, METRICS, PLANNERS
from ratt_opt.studies.quantities import QUANTITIES
from ratt_opt.studies.versions import VERSIONS, hash_of_modules, hash_of_texts
from ratt_opt.vocabulary import current_name

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator, Sequence

    from ratt_opt.missions.players.attackers import OwnAttacker
    from ratt_opt.missions.players.planners import Planner
    from ratt_opt.problem import Problem
    from ratt_opt.scenario.model import Scenario
    from ratt_opt.studies.cases import Case

__all__ = ["Study", "check_names", "path_of", "run_trial"]

COMPARISON = "ratt_opt.studies.comparison:measure"
"""The measure of studies that name no other."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Study:
    """A study as data; :func:`ratt_opt.studies.run` runs it.

    Parameters
    ----------
    name : folder of its results
    version : raised when the meaning of a row changes; older results are then refused
    cases : combinations of factors; every trial visits each of them
    planners : names of :data:`ratt_opt.studies.PLANNERS`, or functions ``(problem) -> elements``, as in missions
    attackers : names of :data:`ratt_opt.studies.ATTACKERS`, or functions ``(problem, elements) -> Attack``.
        Columns of the table call functions by their own names; a mapping ``{name: planner}`` gives others
    metrics : what is measured for every planner and attacker
    quantities : what is measured once for every case and trial
    problem : function ``(case, seeds)`` that makes the :class:`Problem` or :class:`Scenario` of a trial; by default a
        random scenario. Metrics of physical scenarios (``trace``, ``mse``) need a scenario
    measure : function ``(study, case, seeds) -> row`` that measures one trial, or its ``module:function``; by default
        the comparison of planners under attackers
    seed : root of all seeds
    fixed_trials : number of trials if nothing is random; otherwise the command line decides

    Functions stand at the top of their module, so that worker processes find them. A planner or attacker may also be a
    ``functools.partial`` of such a function, or an instance of a dataclass that can be called.

    Raises
    ------
    InputError : there is no planner, attacker or metric of a name; a function is a lambda or stands inside another; or
        two planners or attackers have one name.
    """

    name: str
    version: int = 1
    cases: tuple[Case, ...]
    planners: Sequence[str | Planner] | Mapping[str, str | Planner] = ()
    attackers: Sequence[str | OwnAttacker] | Mapping[str, str | OwnAttacker] = ()
    metrics: tuple[str, ...] = ()
    quantities: tuple[str, ...] = ()
    problem: Callable[[Case, Seeds], Problem | Scenario] | None = None
    measure: str | Callable[[Study, Case, Seeds], dict[str, Cell]] = COMPARISON
    seed: int = 2022
    fixed_trials: int | None = None

    def __post_init__(self) -> None:
        for role in ("planner", "attacker"):
            object.__setattr__(self, f"{role}s", _with_current_names(role, getattr(self, f"{role}s")))
        for kind in ("planners", "attackers"):
            names = list(_named(getattr(self, kind)))
            if len(names) < len(getattr(self, kind)):
                given = getattr(self, kind)
                raise InputError(kind, "must have different names", ", ".join(map(name_of, given)))
            if stray := next((name for name in names if "/" in name), None):
                raise InputError(kind, "must have names without '/', which parts the names of columns", stray)
        for function in self._own():
            path_of(function)
        if self.measure == COMPARISON:
            known: dict[str, Collection[str]] = {"planners": PLANNERS, "attackers": ATTACKERS}
            check_names(self, known | {"metrics": METRICS, "quantities": QUANTITIES})

    @property
    def planner_names(self) -> tuple[str, ...]:
        """Names of the planners in columns."""
        return tuple(self.named_planners)

    @property
    def attacker_names(self) -> tuple[str, ...]:
        """Names of the attackers in columns."""
        return tuple(self.named_attackers)

    @property
    def named_planners(self) -> dict[str, str | Planner]:
        """The planners by what columns call them."""
        return _named(self.planners)

    @property
    def named_attackers(self) -> dict[str, str | OwnAttacker]:
        """The attackers by what columns call them."""
        return _named(self.attackers)

    def _own(self) -> Iterator[Callable[..., Any]]:
        """The functions that are given as such."""
        every = (self.measure, self.problem, *self.named_planners.values(), *self.named_attackers.values())
        yield from (member for member in every if callable(member))

    def modules(self) -> tuple[str, ...]:
        """Return the names of the modules, besides the engine's own, whose code decides the rows."""
        paths = [self.measure if isinstance(self.measure, str) else path_of(self.measure), *map(path_of, self._own())]
        return tuple(sorted({path.partition(":")[0] for path in paths}))

    def code(self) -> str:
        """Return a hash of what these modules hold; of a notebook, which is no file, of the functions' own text."""
        return " ".join(filter(None, (hash_of_modules(self.modules()), hash_of_texts(self._own()))))

    def definition(self) -> dict[str, Any]:
        """Return everything that decides the rows, as JSON types; functions as ``module:function``."""
        plain = {field.name: getattr(self, field.name) for field in fields(self)}
        plain |= {"cases": [asdict(case) for case in self.cases]}
        plain = {name: value for name, value in plain.items() if name != "problem" or value is not None}
        document: dict[str, Any] = json.loads(json.dumps(plain, default=path_of))
        return document

    def fingerprint(self) -> str:
        """Return a hash of the definition; equal exactly for equal definitions."""
        return hashlib.sha256(json.dumps(self.definition(), sort_keys=True).encode()).hexdigest()[:16]


def check_names(study: Study, known: Mapping[str, Collection[str]]) -> None:
    """Refuse names that are not ``known`` of a field, before a trial is run."""
    for field, names in known.items():
        given = getattr(study, field)
        for member in given.values() if isinstance(given, Mapping) else given:
            if isinstance(member, str) and member not in names:
                own = " or functions" if field in {"planners", "attackers"} else ""
                raise InputError(field, f"must be among {', '.join(names)}{own}", member)


def path_of(function: Callable[..., Any]) -> str:
    """Return the ``module:function`` by which other processes find a function; also of the module that was run.

    Of a ``partial`` and of a dataclass's instance its arguments follow in brackets.

    Raises
    ------
    InputError : it has none.
    """
    if isinstance(function, partial):
        return path_of(function.func) + name_of(function).removeprefix(name_of(function.func))
    if is_dataclass(function) and not isinstance(function, type):
        kind: type = type(function)
        return path_of(kind) + repr(function).removeprefix(kind.__qualname__)
    module, name = getattr(function, "__module__", None), getattr(function, "__qualname__", "<")
    if module is None or "<" in name:
        rule = "must be given functions that stand at the top of a module, or dataclasses that can be called"
        raise InputError("study", rule, repr(function))
    run = sys.modules["__main__"].__spec__ if module == "__main__" else None
    return f"{module if run is None else run.name}:{name}"


Member = TypeVar("Member", bound="Callable[..., Any]")


def _named(members: Sequence[str | Member] | Mapping[str, str | Member]) -> dict[str, str | Member]:
    """Planners or attackers by their names in columns."""
    return dict(members) if isinstance(members, Mapping) else {name_of(member): member for member in members}


def _with_current_names(role: str, members: Any) -> Any:
    """The members, those by a former name by that of today."""
    if isinstance(members, Mapping):
        return {name: current_name(role, member, stacklevel=6) for name, member in members.items()}
    return tuple(current_name(role, member, stacklevel=6) for member in members)


def run_trial(study: Study, case: int, trial: int) -> dict[str, Cell]:
    """Measure one trial of one case: the unit of work, a pure function of its arguments."""
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
    measured = measure(study, chosen, seeds)
    _check_metrics(study, measured)
    return {**head, **factors, **dict(chosen.options), **measured}


def _check_metrics(study: Study, measured: Mapping[str, Cell]) -> None:
    """Refuse a row without one of the study's metrics: else only its tables, after all trials, would miss it."""
    found = {parts[2]: None for parts in (name.split("/", 2) for name in measured) if len(parts) > 2}
    lacking = next((metric for metric in study.metrics if metric not in found), None)
    if study.planner_names and study.attacker_names and lacking is not None:
        raise InputError("metrics", f"must be among those measured ({', '.join(found) or 'none'})", lacking)
