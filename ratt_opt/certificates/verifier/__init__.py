"""The independent verifier: decides, exactly, whether a certificate proves its claim.

Open ``verify.py`` first. ``statement.py`` checks the problem and plan a file states, ``upper.py`` and ``lower.py``
its two proofs (the latter with a file for each kind of proof in ``lower_end/``); the proofs of the mathematics are in
the docstrings of what checks them. ``reading.py`` takes the file apart, ``exact_matrices.py`` computes without
rounding, ``verified.py`` says what was proved.
"""
