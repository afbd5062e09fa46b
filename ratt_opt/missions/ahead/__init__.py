"""Several steps ahead: control sequences as elements.

Open ``horizon.py`` first: the sequences, the joint state of all steps and the part of it that counts.
"""
