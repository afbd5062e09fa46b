"""Proof files and the independent verifier."""
