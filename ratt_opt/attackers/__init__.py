"""The inner minimisation: the attack that leaves a plan least, exactly or with a bracket.

Open ``exact.py`` first, then ``schedule.py``: it says which stages run, when, and what share of the budget each has;
``team_attack.py`` and ``criterion_attack.py`` are what its rows ask. The stages are in ``ratt_opt/attack``, those of
functions known by their values alone in ``any_function.py`` and ``attack_tree.py``. ``heuristics.py`` finds first
attacks. ``criticality.py`` and ``link_choice`` (the best links to protect or to add) ask the exact attacker many
questions, ``survey.py`` sets it beside the heuristics.
"""
