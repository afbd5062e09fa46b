"""The smallest ratio of a planner's worst case to the optimum over a class of functions; open ``ratio.py`` first.

``skeleton.py`` lists the planner's comparisons and the attacks, ``class_rows.py`` the linear rows of the class, and
``search.py`` branches on what saves the optimal plan. ``program.py`` and ``multipliers.py`` prove each node's bound in
rationals; ``witness.py`` replays an instance exactly, and ``families.py`` holds two families that attain the bounds.
"""
