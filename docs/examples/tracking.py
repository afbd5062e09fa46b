"""
From a plan to tracking errors
==============================

A value is a prediction. Here the plan is executed, the worst attack happens, the robots that still see measure, and a
Kalman filter estimates: how large are the errors?
"""

import numpy as np
from matplotlib.figure import Figure

import ratt_opt as ro
from ratt_opt.report.palette import look_of

scenario = ro.random_scenario(6, 8, alpha_s=2, alpha_c=4, seed=3)
problem = scenario.problem()
plans = {"ratt": ro.ratt(problem).elements, "random": ro.random_plan(problem, seed=0).elements}
errors = {}
for name, elements in plans.items():
    attack = ro.worst_case_attack(problem, elements).attack
    seeing = problem.best_group(elements, attack)
    run = ro.simulate_tracking(scenario, elements, seeing, seed=0, draws=400)
    errors[name] = np.linalg.norm(run.truth - run.estimates, axis=-1).mean(axis=-1)

# %%
figure = Figure(figsize=(7, 3.6), layout="constrained")
axes = figure.subplots()
bins = np.linspace(0, max(map(np.max, errors.values())), 40)
for name, found in errors.items():
    look = look_of(name)
    axes.hist(
        found, bins, histtype="stepfilled", alpha=0.55, color=look.colour, label=f"{name}: mean {found.mean():.2f} m"
    )
    axes.hist(found, bins, histtype="step", color="#222222", linewidth=0.8)
axes.set_xlabel("mean distance of the estimates from the targets [m], 400 draws")
axes.set_yticks([])
axes.legend(frameon=False)
axes.spines[["top", "right", "left"]].set_visible(False)
assert errors["ratt"].mean() < errors["random"].mean()
