"""Stages of the search for the upper end: one file each, listed in ``schedule.py``, which run in turns.

Open ``bound_stage.py`` first: what a stage is. ``upper_bound_portfolio.py`` gives them their turns.
"""
