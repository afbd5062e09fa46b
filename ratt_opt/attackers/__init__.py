"""The inner minimisation: the attack that leaves a plan least, exactly or with a bracket.

Open ``exact.py`` first, then ``schedule.py``: it says which stages run, when, and what share of the budget each has.
``staging.py`` runs such tables; what their rows ask about is in ``team_attack.py`` and ``criterion_attack.py``. Stages
are in ``by_size`` (complete graphs), ``by_partition``, ``by_covers``, ``by_prices`` (others) and ``forced_group.py``;
``attack/least_sets`` answers what they ask about one group, and ``heuristics`` finds first attacks. ``criticality.py``
and ``link_choice`` (the best links to protect or to add) ask the exact attacker many questions, ``survey.py`` sets it
beside the heuristics; ``task.py`` is what all share.
"""
