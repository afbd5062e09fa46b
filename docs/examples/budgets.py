"""
How much robustness costs, and what it is worth
===============================================

Plans for no attack and for two blinded robots, each under zero to four blinded robots.
"""

from dataclasses import replace

from matplotlib.figure import Figure

import ratt_opt as ro
from ratt_opt.report.palette import look_of

problem = ro.random_scenario(6, 8, alpha_s=2, alpha_c=0, seed=1).problem()
plans = {
    "ratt": ro.ratt(problem).elements,
    "maxmin": ro.solve_maxmin(problem, time_limit=10).elements,
    "nonrobust_optimum": ro.nonrobust_optimum(problem).elements,
}
levels = range(5)
best = [ro.solve_maxmin(replace(problem, alpha_s=k), time_limit=10).upper for k in levels]

# %%
# Drawn is what each misses to the best possible for that very attack, in per cent: the first point is the price of
# robustness.
figure = Figure(figsize=(7, 3.8), layout="constrained")
axes = figure.subplots()
for dodge, (name, elements) in zip((-0.08, 0.0, 0.08), plans.items(), strict=True):  # so that no curve hides another
    missing = [100 * (1 - ro.worst_case_attack(replace(problem, alpha_s=k), elements).upper / best[k]) for k in levels]
    look = look_of(name)
    axes.plot([k + dodge for k in levels], missing, color=look.colour, marker=look.marker, label=name, alpha=0.9)
axes.axvline(2, color="#222222", linestyle=":", label="planned for")
axes.set_xticks(levels)
axes.set_xlabel("robots blinded")
axes.set_ylabel("shortfall from the best possible [%]")
axes.legend(frameon=False)
axes.spines[["top", "right"]].set_visible(False)
