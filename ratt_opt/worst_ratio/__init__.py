"""The smallest ratio of a planner's worst case to the optimum over a class of functions; open ``ratio.py`` first.

``ratio_search.py`` lists the planner's comparisons and the attacks, and branches on what saves the optimal plan;
``class_rows.py`` has the linear rows of the class. ``program.py`` proves each node's bound in rationals.
``witness.py`` replays an instance exactly, and with ``families.py`` holds families of instances that attain bounds.
``closed_form.py`` says what is proved and conjectured of the ratio.
"""
