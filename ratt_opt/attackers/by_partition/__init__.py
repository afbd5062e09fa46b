"""Worst attacks on any graph, by partitions of the team into groups.

Open ``threshold_search.py`` first: up to twenty robots, a table of all sets decides. ``split_search.py`` is for larger
teams that an attack can split in few ways; its ``GroupSurvivors`` say who may be left seeing in one group.
"""
