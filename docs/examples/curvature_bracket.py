"""
A curvature as a bracket that closes
====================================

Guarantees depend on the curvature of the objective, which nobody can compute exactly for large teams. Here it is a
bracket that holds at any moment, and says which sets attain its lower end.
"""

import math

from matplotlib.figure import Figure

import ratt_opt as ro

problem = ro.random_scenario(8, 10, alpha_s=2, alpha_c=7, seed=0).problem("maxeig")
limits = (1, 10, 100, 1000)
brackets = [ro.total_curvature(problem.objective, problem.robot, gap=0.0, max_nodes=n, time_limit=20) for n in limits]

# %%
# What a guarantee multiplies is one minus the curvature, so that is drawn.
figure = Figure(figsize=(6, 3.6), layout="constrained")
axes = figure.subplots()
axes.fill_between(limits, [1 - b.upper for b in brackets], [1 - b.lower for b in brackets], color="#0b5394", alpha=0.35)
axes.plot(limits, [1 - b.upper for b in brackets], "o-", color="#0b5394", label="proved at least")
axes.plot(limits, [1 - b.lower for b in brackets], "s-", color="#4a0d1f", label="attained by a set found")
axes.set(xscale="log", yscale="log", xlabel="nodes searched", ylabel="one minus the total curvature")
axes.legend(frameon=False)
axes.spines[["top", "right"]].set_visible(False)
assert all(b.lower <= b.upper and math.isfinite(b.upper) for b in brackets)
