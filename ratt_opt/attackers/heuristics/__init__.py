"""Attacks without a claim: a lower bound of nothing, an upper bound that their attack attains.

Open ``bounded_rational.py`` first (the paper's attacker); ``greedy.py`` takes the worst single step again and again,
``random_attack.py`` knows nothing. ``partial_attack.py`` is what they build, robot by robot.
"""
