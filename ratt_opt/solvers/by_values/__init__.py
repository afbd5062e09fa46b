"""Best plans of any set function, known by its values alone: a bracket of any size, within any number of values.

Open ``solve_by_values.py`` first: the order of the steps and their shares of the budget. ``plan_attacks.py`` attacks
plans and keeps the best one, ``climbing.py`` improves them against the attacks known so far, ``plan_bounds.py`` bounds
all of them, ``plan_tree.py`` divides them by branch and bound.
"""
