"""Proof files, and the verifier that shares nothing with their authors.

Open ``write.py`` first: ``upper.py`` and ``lower.py`` make the two proofs of a file, the latter by ``size_tree.py``,
``attack_tree.py``, ``group_prices.py``, ``group_covers/`` or ``group_sizes/``. Then ``verifier/verify.py``, which
decides in exact arithmetic whether a file proves its claim.
"""
