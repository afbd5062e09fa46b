"""Proofs that every attack leaves a group worth a threshold, by scores of groups of each size.

Open ``proof.py`` first. ``score_bounds.py`` finds the numbers that show what groups score at most,
``largest_tree.py`` decides robot by robot who is in the largest group, and who sees.
"""
