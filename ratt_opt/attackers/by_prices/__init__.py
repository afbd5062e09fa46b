"""Worst attacks on any graph, by prices of robots and blinded robots that no weak group pays.

Open ``price_search.py`` first: annealed attacks from above (``starts.py``, ``annealing.py``), refuted thresholds
from below. ``decision.py`` decides a threshold: ``prices.py`` finds the prices from the groups it knows,
``paying_groups.py`` proves that no other group pays them, lowering them for those that do (``falling_prices.py``), with
bounds of the links that groups of a size cut (``convex_forms.py``); ``groups/`` is about single groups.
"""
