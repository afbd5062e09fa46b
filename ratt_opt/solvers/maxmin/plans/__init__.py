"""Good plans and the attacks that judge them: the lower end of the search.

Open ``incumbent.py`` first: it improves plans, and proves and keeps the best one. ``candidates.py`` climbs from plans
and ranks them by the known outcomes (``outcome_pool.py``); ``adversary.py`` finds outcomes and chooses among equals.
"""
