"""The inner minimisation: the attack that leaves a plan least, exactly or with a bracket.

Open ``exact.py`` first: it chooses between the searches of ``by_size`` (complete graphs) and, in ``any_graph.py``,
``by_partition`` and ``by_prices`` (others) and the bound of ``forced_group.py``; ``weakest_set`` answers what they
ask about one group, and ``heuristics`` finds first attacks. ``criticality.py`` and ``link_choice`` (the best links to
protect or to add) ask the exact attacker many questions, ``survey.py`` sets it beside the heuristics; ``task.py`` is
what all share.
"""
