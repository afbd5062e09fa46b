"""Figs. ql_1sen_atk, ql_1comm_atk, ql_1sen2comm_atk: RATT and NR-OPT, without and with the worst attack.

``python -m analysis.paper.qualitative --trials 10 --out DIR``
"""

import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from analysis.paper.qualitative_figure import common_limits, draw_scene, legend, squared_error
from ratt_opt._validation import IntArray
from ratt_opt.problem import Attack
from ratt_opt.studies.cases import Case, Cell, Seeds
from ratt_opt.studies.command import Entry, main
from ratt_opt.studies.comparison import DRAWS
from ratt_opt.studies.instance import Instance
from ratt_opt.studies.plots import new_figure, save
from ratt_opt.studies.statistics import select
from ratt_opt.studies.study import Study

STUDY = Study(
    name="qualitative",
    cases=(
        Case(n_robots=2, n_targets=2, alpha_s=1, alpha_c=0),
        Case(n_robots=2, n_targets=2, alpha_s=0, alpha_c=1),
        Case(n_robots=3, n_targets=3, alpha_s=1, alpha_c=2),
    ),
    planners=("ratt", "nonrobust_optimum"),
    attackers=("none", "worst"),
    metrics=("value", "trace", "mse"),
    measure="analysis.paper.qualitative:measure",
)
FIGURES = ("one_sensing_attack", "one_link_attack", "one_sensing_two_link_attacks")


def measure(study: Study, case: Case, seeds: Seeds) -> dict[str, Cell]:
    """Return the metrics, and everything that is drawn, as JSON in one cell per picture."""
    instance = Instance.of(case, seeds)
    row: dict[str, Cell] = {"scenario": instance.digest}
    for planner, chosen in study.named_planners.items():
        plan = instance.plan(chosen)
        for attacker, striking in study.named_attackers.items():
            attack, _ = instance.strike(striking, plan)
            name = f"{planner}/{attacker}"
            row[f"{name}/value"] = instance.problem.team_value(plan, attack)
            row[f"{name}/trace"] = instance.trace(plan, attack)
            row[f"{name}/mse"] = instance.track(plan, attack, draws=DRAWS).mse
            row[f"{name}/picture"] = json.dumps(_picture(instance, plan, attack))
    return row


def _picture(instance: Instance, plan: IntArray, attack: Attack) -> dict[str, Any]:
    tracking = instance.track(plan, attack, draws=1)
    return {
        "now": instance.scenario.poses.tolist(),
        "next": instance.scenario.predicted_poses[plan].tolist(),
        "links": sorted(instance.problem.communication.links),
        "blinded": sorted(attack.sensing),
        "cut": sorted(attack.links),
        "seeing": sorted(instance.problem.best_group(plan, attack)),
        "truth": tracking.truth[0].tolist(),
        "estimate": tracking.estimates[0].tolist(),
        "covariance": tracking.covariances[0].tolist(),
    }


def draw(rows: Sequence[Mapping[str, str]], folder: Path) -> None:
    """One figure per scenario of the paper: the first trial in which the worst attack leaves the planners unequal."""
    for case, name in zip(STUDY.cases, FIGURES, strict=True):
        kept = select(rows, case=case.name)
        shown = next((row for row in kept if row["ratt/worst/value"] != row["nonrobust_optimum/worst/value"]), kept[0])
        cells = [(planner, attacker) for attacker in STUDY.attacker_names for planner in STUDY.planner_names]
        pictures = [json.loads(shown[f"{planner}/{attacker}/picture"]) for planner, attacker in cells]
        window = common_limits(pictures)
        (left, right), (bottom, top) = window["xlim"], window["ylim"]
        figure = new_figure(11, 2.4 + 2 * min(4.6, 4.9 * (top - bottom) / (right - left)))
        for axes, (planner, attacker), picture in zip(figure.subplots(2, 2).flat, cells, pictures, strict=True):
            draw_scene(axes, picture)
            axes.set(**window)
            trace, error = float(shown[f"{planner}/{attacker}/trace"]), squared_error(picture)
            numbers = f"trace {trace:.3g} m², squared error {error:.3g} m² per target"
            axes.set_title(f"{planner}, {'no attack' if attacker == 'none' else 'worst attack'}\n{numbers}")
        figure.legend(handles=legend(), loc="outside lower center", ncols=4, frameon=False)
        save(figure, folder, name)


ENTRY = Entry(STUDY, draw)

if __name__ == "__main__":
    sys.exit(main("Qualitative comparisons of Section VI.", [ENTRY], trials=10))
