"""
How bad can RATT be?
====================

The smallest ratio of RATT's worst case to the optimum, over all submodular functions of a curvature: exact, and
beside it what the paper's theorem promises.
"""

from fractions import Fraction

from matplotlib.figure import Figure

import ratt_opt as ro

curvatures = [Fraction(i, 4) for i in range(1, 4)]
exact = [ro.worst_case_ratio(3, 1, 0, curvature=k, family="submodular") for k in curvatures]

# %%
figure = Figure(figsize=(6, 3.6), layout="constrained")
axes = figure.subplots()
axes.plot(curvatures, [float(r.lower) for r in exact], "o-", color="#0b5394", label="exact, 3 robots, 1 blinded")
axes.plot(curvatures, [float(1 - k) for k in curvatures], "s--", color="#30a574", label="proved for all teams: 1 - k")
axes.plot(
    curvatures,
    [float((1 - k) / (1 + k)) for k in curvatures],
    "v:",
    color="#86648a",
    label="Theorem 1: (1 - k) / (1 + k)",
)
axes.set(xlabel="curvature k", ylabel="share of the optimum", ylim=(0, 1))
axes.legend(frameon=False)
axes.spines[["top", "right"]].set_visible(False)
assert all(r.lower >= 1 - k for r, k in zip(exact, curvatures, strict=True))

# %%
# The instance that attains it replays: its table of values, RATT's plan, the optimum.
exact[-1].witness
