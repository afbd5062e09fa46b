"""Brackets of max-eigenvalue marginals of two-dimensional targets."""
