"""Statements about sizes, groups and counts, decided by running something; open ``setting.py`` first.

``setting.py`` enumerates robots, budgets and group sizes; ``arrangement_claims.py`` fills the groups, and with
``size_claims.py`` tests the appendix on all of them, ``running_time.py`` counts evaluations for Theorem 2, and
``tightness.py`` replays instances that attain the bounds.
"""
