"""Good plans and the attacks that judge them: the lower end of the search.

Open ``incumbent.py`` first: it improves plans and proves the best one, with three collaborators. ``candidates.py``
ranks plans by the known outcomes (``outcome_pool.py``), ``adversary.py`` finds outcomes (``lasting_attack.py`` chooses
among equals), and ``proved_plan.py`` keeps the best proved plan. ``local_search.py`` improves one plan.
"""
