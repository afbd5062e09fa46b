"""Best plans of any set function, known by its values alone: a bracket of any size, within any number of values.

Open ``solve_by_values.py`` first: the order of the steps and their shares of the budget. ``plan_attacks.py`` attacks
plans and keeps the best one, ``climbing.py`` improves them against the attacks known so far, ``plan_bounds.py`` bounds
all of them. ``row_tree.py`` divides the plans of sums of parts and of submodular functions by rows of modular bounds
(``kept_rows.py``, ``part_rows.py``, ``columns.py``, ``outcome_rows.py``; of robots that may be exchanged
``region_rows.py``, ``mean_losses.py``, ``regions.py``), ``plan_tree.py`` those of other functions by monotonicity;
``divided_plans.py`` keeps the parts that are left.
"""
