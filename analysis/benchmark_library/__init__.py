"""The program that fills the folder ``benchmark/``: candidates, their solution by several solvers, and the choice.

Open ``candidates.py`` first. ``solve.py`` tries every candidate and keeps a journal, ``choose.py`` picks a library from
it; ``python -m analysis.benchmark_library`` runs both, and goes on where it stopped.
"""
