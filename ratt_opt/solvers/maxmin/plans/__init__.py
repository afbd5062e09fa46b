"""Good plans and the attacks that judge them: the lower end of the search.

Open ``incumbent.py`` first: plans are climbed from and ranked by the known outcomes (``candidates.py``,
``outcome_pool.py``), and the best one is proved and kept; ``walk.py`` looks for better ones next to it.
``adversary.py`` finds outcomes for a plan and chooses among equals, ``node_attacks.py`` those for all plans of a node.
"""
