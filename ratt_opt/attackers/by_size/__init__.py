"""Worst attacks on complete graphs without protected links, where outcomes differ by their group sizes.

Open ``size_vector_search.py``: it searches the largest group by ``../weakest_set``, packs the smaller ones, and bounds
graphs with protected links by those without.
"""
