"""Statements about sizes, groups and counts, decided by running something; open ``arrangements.py`` first.

``arrangements.py`` enumerates robots, budgets and the ways to fill groups; ``arrangement_claims.py`` and
``size_claims.py`` test the appendix on all of them, ``running_time.py`` counts evaluations for Theorem 2, and
``tightness.py`` replays instances that attain the bounds.
"""
