"""Gain from robust planning: missions of teams whose robots must choose what to look at.

Open ``flights.py`` first: planners against attackers. ``claim.py`` measures the README's claim, ``verdicts.py`` turns
paired intervals into words.
"""
