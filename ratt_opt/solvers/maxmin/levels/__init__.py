"""Searches in depth over all plans that ask whether one is worth more than a level.

Open ``by_levels.py`` first: which levels are tried, one search each (``level_search.py``). ``elements.py``: the
elements that plans need. What ends a search are covers (``covers/``) or marginal gains (``marginals/``).
"""
