"""The open benchmark: instances with proved optima, records, and a runner for any planner.

Open ``instances/instance.py`` first: a problem in one of four forms, and its class. ``proofs/`` verifies what is known
of it, ``runs/`` tries solvers on a library.
"""
