"""The independent verifier: decides, exactly, whether a certificate proves its claim.

Open ``verify.py`` first. ``statement.py`` checks the problem and plan a file states, ``upper.py`` and ``lower.py``
its two proofs. Of the upper one ``tangents.py`` bounds sets by points, ``target_lemmas.py`` checks lemmas and adds up
rows, ``spacing.py`` says which values plans can have. Of the lower one ``cases.py`` follows the trees, ``duals.py``
and ``sizes.py`` say what follows from them, ``worth.py`` values sets of robots. The proofs of the mathematics are in
the docstrings of what checks them. ``reading.py`` takes the file apart, ``exact_matrices.py`` computes without
rounding, ``verified.py`` says what was proved.
"""
