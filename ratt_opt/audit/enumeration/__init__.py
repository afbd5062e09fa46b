"""Statements about sizes, groups and counts, decided by running something; open ``setting.py`` first.

``setting.py`` enumerates robots and budgets, ``arrangements.py`` the ways to fill groups. ``arrangement_claims.py``,
``size_claims.py`` and ``smallest_teams.py`` test the appendix on all of them, ``running_time.py`` counts evaluations
for Theorem 2, and ``tightness.py`` replays instances that attain the bounds.
"""
