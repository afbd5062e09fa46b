"""Missions over recorded data: real poses and real measurements, with simulated attacks.

Open ``replay.py`` first: landmarks of the MRCLAM dataset, tracked by the groups that attacks leave. ``fit_sensor.py``
estimates noise law and outlier gate from residuals.
"""
