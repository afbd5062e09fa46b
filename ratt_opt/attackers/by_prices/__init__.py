"""Worst attacks on any graph, by dual prices of robots and blinded robots that no group below a threshold pays.

Open ``price_search.py`` first: annealed attacks from above (``attack/annealing.py``), refuted thresholds from below.
``decision.py`` decides a threshold: ``prices.py`` finds the prices from the groups it knows, ``column_search.py`` asks
``attack/pricing.py`` whether other groups pay them, and lowers them for those that do (``falling_prices.py``).
``partitions.py`` tries partitions into groups that nearly pay.
"""
