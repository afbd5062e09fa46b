"""Solvers of the benchmark made of Python functions: the library's, published ones, and yours by entry point.

``python -m ratt_opt.benchmark.runs.solvers planner:NAME INSTANCE OUT --time S`` prints what a foreign solver prints. A
planner is ``f(problem)``, an attacker ``f(problem, elements)``. Yours is found in the entry-point group
``ratt_opt.planners`` or ``ratt_opt.attackers``, or is named ``module:function``.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from importlib.metadata import entry_points
from pathlib import Path
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any

from ratt_opt.attack.edge_cuts.fewest import fewest_cuts
from ratt_opt.attack.exact import worst_case_attack
from ratt_opt.attack.heuristics import bounded_rational_attack, greedy_attack
from ratt_opt.benchmark.instances.forms import SumInput, TableInput
from ratt_opt.benchmark.instances.instance import BenchmarkInstance, read_instance
from ratt_opt.benchmark.proofs.answers import only_plan
from ratt_opt.benchmark.proofs.verification import stated_problem
from ratt_opt.certificates.edge_cuts import certify_cuts
from ratt_opt.certificates.write import certify
from ratt_opt.errors import InputError, ProofError, UndecidedError
from ratt_opt.missions.players.planners import PLANNERS, elements_of
from ratt_opt.planners.scenario_program import ScenarioPlan, scenario_program
from ratt_opt.solvers.maxmin.solve import solve_maxmin
from ratt_opt.solvers.refined import refined

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt.problem import Attack

__all__ = ["find_solver", "main", "names"]

SEARCH_SHARE = 0.6
"""Share of the time for a search; the rest is for its certificate."""
CERTIFICATE = "certificate.json"
ATTACKERS: dict[str, Callable[..., Any]] = {
    "greedy": greedy_attack,
    "bounded_rational": bounded_rational_attack,
    "worst": worst_case_attack,
}


def main(arguments: list[str] | None = None) -> int:
    """Solve one instance and print what is found; 2 for bad input."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("solver")
    parser.add_argument("instance", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--time", type=float, required=True)
    options = parser.parse_args(arguments)
    began = time.monotonic()
    try:
        instance = read_instance(options.instance)
        track, _, name = options.solver.partition(":")
        solve = find_solver(track, name)
        solve(instance, options.out, options.time - (time.monotonic() - began))
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


def names() -> dict[str, tuple[str, ...]]:
    """Names of solvers that need no ``module:function``, by what they are."""
    own = {
        kind: tuple(point.name for point in entry_points(group=f"ratt_opt.{kind}s")) for kind in ("planner", "attacker")
    }
    return {
        "planner": (*PLANNERS, *(name for name in SPECIAL if name not in PLANNERS), *own["planner"]),
        "attacker": (*ATTACKERS, *own["attacker"]),
        "cuts": ("fewest_cuts",),
    }


def find_solver(track: str, name: str) -> Callable[[BenchmarkInstance, Path, float], None]:
    """The solver of a track and name: it solves an instance within some seconds and prints.

    Raises
    ------
    InputError : there is none of that name.
    """
    if track == "cuts" and name == "fewest_cuts":
        return _cuts
    if track == "attacker" and name == "worst":
        return _worst
    if track == "planner" and name in SPECIAL:
        return SPECIAL[name]
    known: dict[str, Any] = {"planner": PLANNERS, "attacker": ATTACKERS}.get(track, {})
    function = known.get(name) or _foreign(track, name)
    runner = _plan_by if track == "planner" else _attack_by
    return lambda instance, _out, seconds: runner(instance, function, seconds)


def _foreign(track: str, name: str) -> Callable[..., Any]:
    """A function by entry point or by its path."""
    if track in {"planner", "attacker"}:
        for point in entry_points(group=f"ratt_opt.{track}s", name=name):
            return point.load()  # type: ignore[no-any-return]
        if ":" in name:
            sys.path.insert(0, "")
            try:
                return resolve_name(name)  # type: ignore[no-any-return]
            except (ImportError, AttributeError, ValueError) as error:
                raise InputError(name, "must be module:function that can be imported", error) from None
    listed = ", ".join(f"{kind}:{one}" for kind, all_names in names().items() for one in all_names)
    raise InputError("solver", f"must be one of {listed}, or planner:module:function", f"{track}:{name}")


def _say(**fields: Any) -> None:
    print(json.dumps({name: value for name, value in fields.items() if value is not None}), flush=True)


def _need(instance: BenchmarkInstance, track: str) -> None:
    if instance.track != track:
        raise InputError("instance", f"must be of the track {track} for this solver", instance.track)


def _plan_by(instance: BenchmarkInstance, plan: Callable[..., Any], _seconds: float) -> None:
    _need(instance, "plan")
    found = plan(instance.team)
    upper = getattr(found, "upper", getattr(found, "claimed_upper", None))
    _say(elements=elements_of(found, instance.team).tolist(), lower=getattr(found, "lower", None), upper=upper)


def _attack_by(instance: BenchmarkInstance, attack: Callable[..., Any], _seconds: float) -> None:
    _need(instance, "attack")
    found = attack(instance.team, only_plan(instance))
    chosen: Attack = getattr(found, "attack", found)
    links = [list(link) for link in sorted(chosen.links)]
    _say(sensing=sorted(chosen.sensing), links=links, lower=getattr(found, "lower", None))


def _refined(instance: BenchmarkInstance, _out: Path, seconds: float) -> None:
    _need(instance, "plan")
    found = refined(instance.team, time_limit=0.8 * seconds, on_improvement=lambda plan: _say(elements=plan.tolist()))
    _say(elements=found.elements.tolist(), lower=found.lower)


def _maxmin(instance: BenchmarkInstance, out: Path, seconds: float) -> None:
    """Search, print, and prove; a sum is searched as the criterion by which its bound is proved."""
    _need(instance, "plan")
    began = time.monotonic()
    _plan_by(instance, PLANNERS["ratt"], seconds)
    by_values = isinstance(instance.problem, TableInput)
    if by_values:
        team = instance.team
    else:
        given, objective = stated_problem(instance)
        team = given.problem(objective)
    result = solve_maxmin(team, time_limit=max(SEARCH_SHARE * seconds, 0.1))
    is_sum = isinstance(instance.problem, SumInput)
    ends = {} if is_sum else {"lower": result.lower, "upper": result.upper}
    _say(elements=result.elements.tolist(), **ends)
    if by_values:
        return
    left = max(seconds - (time.monotonic() - began), 0.1)
    _certified(lambda: certify(team, result, out / CERTIFICATE, time_limit=left))


def _worst(instance: BenchmarkInstance, out: Path, seconds: float) -> None:
    """Attack, print, and prove: the only plan's worst case is what its certificate proves."""
    _need(instance, "attack")
    began = time.monotonic()
    _attack_by(instance, lambda p, e: worst_case_attack(p, e, time_limit=SEARCH_SHARE * seconds), seconds)
    if isinstance(instance.problem, TableInput):
        return
    given, objective = stated_problem(instance)
    team, left = given.problem(objective), max(seconds - (time.monotonic() - began), 0.1)
    only = solve_maxmin(team, time_limit=left / 2)
    _certified(lambda: certify(team, only, out / CERTIFICATE, time_limit=left / 2))


def _program(instance: BenchmarkInstance, _out: Path, seconds: float) -> None:
    _need(instance, "plan")

    def show(plan: ScenarioPlan) -> None:
        _say(elements=plan.elements.tolist(), lower=plan.lower, upper=plan.claimed_upper)

    show(scenario_program(instance.team, time_limit=0.9 * seconds, on_improvement=show))


def _cuts(instance: BenchmarkInstance, out: Path, seconds: float) -> None:
    _need(instance, "cuts")
    network, began = instance.network, time.monotonic()
    limits: dict[str, Any] = {"weights": network.weight_of, "sizes": network.sizes}
    found = fewest_cuts(network.graph, network.size, time_limit=SEARCH_SHARE * seconds, **limits)
    _say(cut=[list(link) for link in sorted(found.cut)], lower=found.lower, upper=found.upper)
    left = max(seconds - (time.monotonic() - began), 0.1)
    _certified(lambda: certify_cuts(network.graph, found, out / CERTIFICATE, time_limit=left, **limits))


def _certified(write: Callable[[], object]) -> None:
    """Print the name of a certificate if one is written; what cannot be proved in time is none."""
    try:
        write()
    except (InputError, ProofError, UndecidedError) as error:
        print(f"no certificate: {error}", file=sys.stderr)
        return
    _say(certificate=CERTIFICATE)


SPECIAL: dict[str, Callable[[BenchmarkInstance, Path, float], None]] = {
    "refined": _refined,
    "maxmin": _maxmin,
    "scenario_program": _program,
}
"""Planners that use the time they are given, and print more than a plan."""

if __name__ == "__main__":
    sys.exit(main())
