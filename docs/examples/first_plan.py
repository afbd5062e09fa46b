"""
A plan, its worst attack, and the proof
=======================================

Six cameras that turn, in six lines: what each should look at, the worst that can follow, and how far any plan could be
from that.
"""

import ratt_opt as ro

scenario = ro.limited_view_scenario(6, 6, alpha_s=2, alpha_c=4, seed=0, view=60, reach=40, communication_range=45)
report = ro.bound(scenario)
figure = report.plot()

# %%
# The same as tables. Every number is a bracket; one number means that both ends agree.
report

# %%
# ``report.save("results")`` writes the page, the archive, the plan as a table, and pictures.
assert report.recommended.worst_case.lower <= report.upper
