"""The inner minimisation: the attack that leaves a plan least, exactly or with a bracket; and what to protect.

Open ``exact.py`` first, then ``stages/schedule.py``: it says which stages run, when, and what share of the budget each
has. ``thresholds`` decides which values an attack can push a team down to, ``size_vectors`` does so on complete graphs,
``least_sets`` answers what both ask about one group, and ``bounds.py`` needs no search. ``edge_cuts`` is about cuts
alone. ``heuristics.py`` finds first attacks, ``survey.py`` sets the exact attack beside them, and ``protection`` asks
it many questions. ``task.py`` is what all are given, ``params`` are their numbers.
"""
