"""Proof files, and the verifier that shares nothing with their authors.

Open ``write.py`` first: ``upper.py`` and ``lower.py`` make the two proofs of a file. The former states rows by
``stated_inequalities.py``, whose lemmas get their trees in ``target_trees.py``; the latter asks ``covers.py`` and
``group_sizes/``, with trees of ``group_tree.py``. Then ``verifier/verify.py``, which decides in exact arithmetic
whether a file proves its claim.
"""
