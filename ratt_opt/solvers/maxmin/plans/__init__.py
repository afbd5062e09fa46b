"""Good plans and the attacks that judge them: the lower end of the search.

Open ``incumbent.py`` first: it climbs from plans, ranks them by the known outcomes (``outcome_pool.py``), and proves
and keeps the best one; ``kicks.py`` looks for better ones next to it. ``adversary.py`` finds outcomes for a plan and
chooses among equals, ``node_attacks.py`` those for all plans of a node.
"""
