"""Planners: RATT and its baselines, the optimum by enumeration, and the exact max-min search.

Open ``ratt.py`` first: Algorithm 1 and the planners it is compared with. ``exhaustive.py`` is the reference for all of
them; ``maxmin/solve.py`` finds and proves the optimum if enumeration cannot, and asks either for the best
plan when nobody attacks. ``result.py`` is what they return.
"""
