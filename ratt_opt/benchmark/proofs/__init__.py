"""Proofs of records: answers valued again, bounds by certificates, and the table that only these change.

Open ``verification.py`` first. ``answers.py`` values, ``relaxation.py`` makes coverage a criterion for certificates,
``enumeration.py`` does small problems by definition, and ``records.py`` keeps the table.
"""
