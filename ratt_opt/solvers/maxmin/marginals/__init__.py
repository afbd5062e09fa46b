"""Marginal gains: what robots that have not chosen yet can add under one attack, each alone.

For log-determinants, which are submodular. Open ``marginal_search.py`` first; ``diving.py`` is the search at one level,
``native/src/marginal_dive.c`` its compiled part (on ``tables.py``), ``raised.py`` the information that it counts with.
"""
