"""Bag in, plan out: the tracker over a recorded ROS bag.

Open ``loop.py`` first: the steps of a replay. ``mapping.py`` says which topic is which robot's, ``reading.py`` reads
poses and detections without ROS, ``written.py`` writes tables, a figure and a log for viewers.
"""
