"""Worst attacks on any graph, by prices of robots and blinded robots that no weak group pays.

Open ``price_search.py`` first: annealed attacks from above (``starts.py``, ``annealing.py``), refuted thresholds
from below.
``decision.py`` decides a threshold: ``prices.py`` finds the prices from the groups of ``cheap_groups.py``,
``columns.py`` lists all groups that may pay them (pruned by ``flow.py``, ``weak_sizes.py`` and what a group needs
blinded, ``needs.py``), ``cover.py`` puts listed groups together.
"""
