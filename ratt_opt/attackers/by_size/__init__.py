"""Worst attacks on complete graphs without protected links, where outcomes differ by their group sizes.

Open ``size_vector_search.py`` first: it searches the largest group by ``../weakest_set`` and packs the smaller ones by
``packing.py``. ``unprotected_links.py`` bounds graphs with protected links by those without.
"""
