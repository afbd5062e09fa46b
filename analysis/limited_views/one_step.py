"""Single plans under the exact worst attack, beside the best possible value, in some cells of the study."""

from analysis.limited_views.flights import COMPLETE, PLANNERS, case_of, scenario_of
from ratt_opt.attack.exact import worst_case_attack
from ratt_opt.missions.players.planners import elements_of, get_planner, planned_with
from ratt_opt.scenario.planner_world import scenario_world
from ratt_opt.solvers.maxmin.solve import solve_maxmin
from ratt_opt.studies.cases import Case, Cell, Seeds
from ratt_opt.studies.command import Entry
from ratt_opt.studies.study import Study

__all__ = ["ENTRY", "STUDY", "measured"]

GAP, NODES = 1e-3, 3_000
"""Gap and nodes at which the search for the best plan stops; nodes, so that rows are the same on every machine."""


def measured(study: Study, case: Case, seeds: Seeds) -> dict[str, Cell]:
    """The worst case of each plan in the first step of the mission, and the bracket of the best possible one."""
    scenario = scenario_of(case, seeds)
    problem = scenario.problem(case.objective)
    world = scenario_world(scenario, problem)
    row: dict[str, Cell] = {}
    for planner, chosen in study.named_planners.items():
        plan = elements_of(planned_with(get_planner(chosen), problem, world), problem)
        row[f"{planner}/worst/value"] = worst_case_attack(problem, plan).lower
    best = solve_maxmin(problem, gap=GAP, max_nodes=NODES)
    return row | {"optimum/lower": best.lower, "optimum/upper": best.upper, "optimum/stop": best.stop.value}


STUDY = Study(
    name="limited_views_one_step",
    cases=(*(case_of(view=view) for view in (60, 30, 120, 360)), case_of(links=COMPLETE)),
    planners=tuple(name for name in PLANNERS if name != "maxmin"),
    attackers=("worst",),
    metrics=("value",),
    measure=measured,
)
ENTRY = Entry(STUDY)
