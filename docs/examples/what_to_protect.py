"""
What to protect first
=====================

The value lost when a robot or link alone is attacked says little. What counts is what the *worst case* gains when one
is protected.
"""

from matplotlib.figure import Figure

import ratt_opt as ro

problem = ro.random_scenario(6, 6, alpha_s=1, alpha_c=3, seed=2).problem("logdet")
plan = ro.ratt(problem).elements
ranking = ro.criticality_ranking(problem, plan)[:8]

# %%
names = [f"robot {c.target}" if isinstance(c.target, int) else f"link {c.target[0]}-{c.target[1]}" for c in ranking]
figure = Figure(figsize=(7, 3.8), layout="constrained")
axes = figure.subplots()
rows = range(len(ranking))
axes.barh(rows, [c.loss for c in ranking], height=0.75, color="#b4b9be", label="lost if it alone is attacked")
axes.barh(rows, [c.gain_lower for c in ranking], height=0.4, color="#0b5394", label="gained if it is protected")
axes.set_yticks(rows, names)
axes.invert_yaxis()
axes.set_xlabel("log-det value")
axes.legend(frameon=False)
axes.spines[["top", "right"]].set_visible(False)

# %%
# And the smallest budgets that push the plan below nine tenths of what it keeps now.
kept = ro.worst_case_attack(problem, plan).upper
for budget in ro.breaking_budgets(problem, plan, 0.9 * kept):
    print(budget)
