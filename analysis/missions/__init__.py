"""Missions under attack as studies.

Open ``flights.py`` first: planners, attackers and attack models over whole missions. ``consistency.py`` asks whether
the filter's covariance tells its error, ``claims.py`` judges both.
"""
