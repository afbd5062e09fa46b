"""Stages of the exact attack, and the schedules that list them in order.

Open ``schedule.py`` first: one line a stage. Each file holds the stages of one kind: what they do, when they apply, and
their share of the budget. ``attack_state.py`` is what they are given: the task, and what earlier stages found out.
"""
