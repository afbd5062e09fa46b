"""Planners: RATT and its baselines, the optimum by enumeration, and the exact max-min search.

Open ``ratt.py`` first: Algorithm 1. ``baselines.py`` has the planners it is compared with and ``exhaustive.py`` the
reference for all of them; ``maxmin/solve.py`` finds and proves the optimum where enumeration cannot, and
``nonrobust.py`` asks either for the best plan when nobody attacks. ``result.py`` is what they return.
"""
