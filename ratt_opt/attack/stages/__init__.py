"""Stages of the exact attack, and the schedules that list them in order.

Open ``schedule.py`` first; ``team_attack.py`` and ``criterion_attack.py`` are what its rows ask. ``any_function.py``,
``attack_tree.py`` and ``every_attack.py`` serve functions that are known by their values alone.
"""
