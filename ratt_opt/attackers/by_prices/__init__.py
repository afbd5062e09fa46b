"""Worst attacks on any graph, by prices of robots and blinded robots that no weak group pays.

Open ``price_search.py`` first: annealed attacks from above (``starts.py``, ``annealing.py``), refuted thresholds
from below.
``decision.py`` decides a threshold: ``prices.py`` finds the prices from the groups of ``cheap_groups.py``,
``paying_groups.py`` proves that no other group pays them (``seeing_sets.py``, by ``flow.py`` and ``weak_sizes.py``),
``columns.py`` lists all groups that nearly do (``needs.py`` says what a group needs blinded), ``cover.py`` puts listed
groups together.
"""
