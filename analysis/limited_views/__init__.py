"""Gain from robust planning: teams whose robots must choose what to look at, over missions and in one step.

Open ``flights.py`` first: planners against attackers over missions. ``one_step.py`` compares single plans with the best
possible one, ``verdicts.py`` turns paired intervals into words, ``page.py`` makes the page of all of it.
"""
