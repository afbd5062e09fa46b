"""The claims of the ledger tried on EKF objectives; open ``violations.py`` first.

``cast.py`` gives the names of a claim to the elements of a real instance: RATT's choices and an optimal plan's,
and evaluates the criteria without rounding, to replay the largest violation that was found.
"""
