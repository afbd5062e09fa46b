"""One instance on many cores: open nodes of a search are searched elsewhere, and their proofs come back.

Open ``shared_search.py`` first: the loop that lends nodes and takes proofs. ``worker.py`` is what happens
elsewhere, ``merge.py`` hangs what came back below the nodes it is about, ``crew.py`` knows who works and who was lost.
"""
