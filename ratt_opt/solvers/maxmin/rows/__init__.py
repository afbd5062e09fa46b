"""Rows of inequalities target by target: for criteria that are sums over targets.

An *inequality* bounds one target's value, whatever set of elements survives (``inequalities.py``): tangents of its
concave value, base sets with the largest marginals beyond them (``base_sets.py``), and where these stall at the root
the lowest ones that there are (``hulls.py``). A *row* adds up one inequality of each target and bounds what a group is
worth (``pool.py``). ``exchanges.py`` looks for attacks that leave rows little.
"""
