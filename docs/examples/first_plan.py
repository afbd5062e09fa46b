"""
A plan, its worst attack, and the proof
=======================================

The paper's small scenario in six lines: what to do now, the worst that can follow, and how far any plan could be from
that.
"""

import ratt_opt as ro

scenario = ro.random_scenario(4, 4, alpha_s=1, alpha_c=3, seed=14)
report = ro.bound(scenario)
figure = report.plot()

# %%
# The same as tables. Every number is a bracket; one number means that both ends agree.
report

# %%
# ``report.save("results")`` writes the page, the archive, the plan as a table, and pictures.
assert report.recommended.worst_case.lower <= report.upper
